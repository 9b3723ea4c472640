//! Radii and colors of the chemical elements.

/// A chemical element.
pub(super) struct Element {
    pub(super) symbol: &'static str,
    /// The van der Waals radius in hundredths of an angstrom; 0 if it is not known.
    radius: u16,
    /// The color as `0xrrggbb`.
    color: u32,
}

impl Element {
    /// Returns the van der Waals radius in angstroms.
    pub(super) fn radius(&self) -> f64 {
        let radius = if self.radius == 0 {
            UNKNOWN_RADIUS
        } else {
            self.radius
        };
        f64::from(radius) / 100.0
    }

    /// Returns the channels of the color.
    pub(super) fn color(&self) -> [f64; 3] {
        [16, 8, 0].map(|shift| f64::from(self.color >> shift & 0xff) / 255.0)
    }

    /// Returns the element with a symbol, in any case, or with an atomic number, and its number.
    pub(super) fn of(text: &str) -> Option<(u8, &'static Self)> {
        let number = match text.parse::<usize>() {
            Ok(number) => number,
            // Isotopes of hydrogen have symbols of their own.
            Err(_)
                if ["D", "T"]
                    .iter()
                    .any(|isotope| text.eq_ignore_ascii_case(isotope)) =>
            {
                1
            }
            Err(_) => {
                let mut all = ELEMENTS.iter();
                1 + all.position(|element| element.symbol.eq_ignore_ascii_case(text))?
            }
        };
        let element = ELEMENTS.get(number.checked_sub(1)?)?;
        Some((u8::try_from(number).ok()?, element))
    }
}

/// The radius of elements without a known one, as in Jmol.
const UNKNOWN_RADIUS: u16 = 200;

/// The stand-in for everything that is not an element, such as `X`, `Du` and lone pairs.
pub(super) static NEUTRAL: Element = element("X", 100, 0x808080);

const fn element(symbol: &'static str, radius: u16, color: u32) -> Element {
    Element {
        symbol,
        radius,
        color,
    }
}

/// All elements in the order of their atomic numbers.
///
/// Radii: Santiago Alvarez, A cartography of the van der Waals territories, Dalton Transactions 42,
/// 2013, table 1. Colors: Jmol, jmol.sourceforge.net/jscolors, which has 109 elements and a color for
/// all others.
const ELEMENTS: [Element; 118] = [
    element("H", 120, 0xffffff),
    element("He", 143, 0xd9ffff),
    element("Li", 212, 0xcc80ff),
    element("Be", 198, 0xc2ff00),
    element("B", 191, 0xffb5b5),
    element("C", 177, 0x909090),
    element("N", 166, 0x3050f8),
    element("O", 150, 0xff0d0d),
    element("F", 146, 0x90e050),
    element("Ne", 158, 0xb3e3f5),
    element("Na", 250, 0xab5cf2),
    element("Mg", 251, 0x8aff00),
    element("Al", 225, 0xbfa6a6),
    element("Si", 219, 0xf0c8a0),
    element("P", 190, 0xff8000),
    element("S", 189, 0xffff30),
    element("Cl", 182, 0x1ff01f),
    element("Ar", 183, 0x80d1e3),
    element("K", 273, 0x8f40d4),
    element("Ca", 262, 0x3dff00),
    element("Sc", 258, 0xe6e6e6),
    element("Ti", 246, 0xbfc2c7),
    element("V", 242, 0xa6a6ab),
    element("Cr", 245, 0x8a99c7),
    element("Mn", 245, 0x9c7ac7),
    element("Fe", 244, 0xe06633),
    element("Co", 240, 0xf090a0),
    element("Ni", 240, 0x50d050),
    element("Cu", 238, 0xc88033),
    element("Zn", 239, 0x7d80b0),
    element("Ga", 232, 0xc28f8f),
    element("Ge", 229, 0x668f8f),
    element("As", 188, 0xbd80e3),
    element("Se", 182, 0xffa100),
    element("Br", 186, 0xa62929),
    element("Kr", 225, 0x5cb8d1),
    element("Rb", 321, 0x702eb0),
    element("Sr", 284, 0x00ff00),
    element("Y", 275, 0x94ffff),
    element("Zr", 252, 0x94e0e0),
    element("Nb", 256, 0x73c2c9),
    element("Mo", 245, 0x54b5b5),
    element("Tc", 244, 0x3b9e9e),
    element("Ru", 246, 0x248f8f),
    element("Rh", 244, 0x0a7d8c),
    element("Pd", 215, 0x006985),
    element("Ag", 253, 0xc0c0c0),
    element("Cd", 249, 0xffd98f),
    element("In", 243, 0xa67573),
    element("Sn", 242, 0x668080),
    element("Sb", 247, 0x9e63b5),
    element("Te", 199, 0xd47a00),
    element("I", 204, 0x940094),
    element("Xe", 206, 0x429eb0),
    element("Cs", 348, 0x57178f),
    element("Ba", 303, 0x00c900),
    element("La", 298, 0x70d4ff),
    element("Ce", 288, 0xffffc7),
    element("Pr", 292, 0xd9ffc7),
    element("Nd", 295, 0xc7ffc7),
    element("Pm", 0, 0xa3ffc7),
    element("Sm", 290, 0x8fffc7),
    element("Eu", 287, 0x61ffc7),
    element("Gd", 283, 0x45ffc7),
    element("Tb", 279, 0x30ffc7),
    element("Dy", 287, 0x1fffc7),
    element("Ho", 281, 0x00ff9c),
    element("Er", 283, 0x00e675),
    element("Tm", 279, 0x00d452),
    element("Yb", 280, 0x00bf38),
    element("Lu", 274, 0x00ab24),
    element("Hf", 263, 0x4dc2ff),
    element("Ta", 253, 0x4da6ff),
    element("W", 257, 0x2194d6),
    element("Re", 249, 0x267dab),
    element("Os", 248, 0x266696),
    element("Ir", 241, 0x175487),
    element("Pt", 229, 0xd0d0e0),
    element("Au", 232, 0xffd123),
    element("Hg", 245, 0xb8b8d0),
    element("Tl", 247, 0xa6544d),
    element("Pb", 260, 0x575961),
    element("Bi", 254, 0x9e4fb5),
    element("Po", 0, 0xab5c00),
    element("At", 0, 0x754f45),
    element("Rn", 0, 0x428296),
    element("Fr", 0, 0x420066),
    element("Ra", 0, 0x007d00),
    element("Ac", 280, 0x70abfa),
    element("Th", 293, 0x00baff),
    element("Pa", 288, 0x00a1ff),
    element("U", 271, 0x008fff),
    element("Np", 282, 0x0080ff),
    element("Pu", 281, 0x006bff),
    element("Am", 283, 0x545cf2),
    element("Cm", 305, 0x785ce3),
    element("Bk", 340, 0x8a4fe3),
    element("Cf", 305, 0xa136d4),
    element("Es", 270, 0xb31fd4),
    element("Fm", 0, 0xb31fba),
    element("Md", 0, 0xb30da6),
    element("No", 0, 0xbd0d87),
    element("Lr", 0, 0xc70066),
    element("Rf", 0, 0xcc0059),
    element("Db", 0, 0xd1004f),
    element("Sg", 0, 0xd90045),
    element("Bh", 0, 0xe00038),
    element("Hs", 0, 0xe6002e),
    element("Mt", 0, 0xeb0026),
    element("Ds", 0, 0xff1493),
    element("Rg", 0, 0xff1493),
    element("Cn", 0, 0xff1493),
    element("Nh", 0, 0xff1493),
    element("Fl", 0, 0xff1493),
    element("Mc", 0, 0xff1493),
    element("Lv", 0, 0xff1493),
    element("Ts", 0, 0xff1493),
    element("Og", 0, 0xff1493),
];
