//! Radii and colors of the chemical elements.

use std::sync::LazyLock;

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
pub(super) static NEUTRAL: Element = Element {
    symbol: "X",
    radius: 100,
    color: 0x80_80_80,
};

/// All elements in the order of their atomic numbers: symbol, radius and color.
///
/// Radii: Santiago Alvarez, A cartography of the van der Waals territories, Dalton Transactions 42,
/// 2013, table 1. Colors: Jmol, jmol.sourceforge.net/jscolors, which has 109 elements and a color for
/// all others.
static ELEMENTS: LazyLock<Vec<Element>> = LazyLock::new(|| {
    let element = |line: &'static str| {
        let mut words = line.split(' ');
        Some(Element {
            symbol: words.next()?,
            radius: words.next()?.parse().ok()?,
            color: u32::from_str_radix(words.next()?, 16).ok()?,
        })
    };
    include_str!("elements.txt")
        .lines()
        .filter_map(element)
        .collect()
});
