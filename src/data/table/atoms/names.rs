//! The element of an atom by its name, for PDB files without a column of elements.

use super::elements::Element;

/// The residues of proteins and nucleic acids, also as simulation programs call them. Their atoms are
/// of N, C, O, S, P, H and Se.
const POLYMERS: &str = "ALA ARG ASN ASP CYS GLN GLU GLY HIS ILE LEU LYS MET PHE PRO SER THR TRP TYR VAL \
    ASX GLX UNK MSE SEC PYL ACE NME NH2 HID HIE HIP HSD HSE HSP CYX CYM ASH GLH LYN SEP TPO PTR HYP \
    A C G I U T N DA DC DG DI DT DU RA RC RG RU ADE CYT GUA URA THY";

/// The names of points that are not atoms.
const NOT_ATOMS: [&str; 3] = ["DU", "DUM", "VS"];

/// The last element that names spell with two letters: `NH1`, `CN2` and `OG1` are atoms of ligands.
const LAST: u8 = 103;

/// Returns the symbol of an element, or the name itself if it does not begin with one. `columns` are
/// the four columns of the name: its element is right-aligned in the first two, so that `CA` is calcium
/// and ` CA ` a carbon. Names of four letters, and those of programs that align all of them to the left,
/// begin one column early.
pub(super) fn symbol(columns: &str, residue: &str) -> String {
    let name = columns.trim();
    let all = letters(name);
    // An ion, or another molecule of one atom.
    if name.eq_ignore_ascii_case(residue) || is_any(&NOT_ATOMS, &all) {
        return or(all, name);
    }
    let first = all.get(..1).unwrap_or_default();
    if is_polymer(residue) {
        let selenium = all.get(..2).filter(|two| two.eq_ignore_ascii_case("Se"));
        return or(selenium.unwrap_or(first).to_owned(), name);
    }
    let two = letters(columns.get(..2).unwrap_or_default());
    let is_hydrogen = name.len() == 4 && two.starts_with(['H', 'D']);
    match Element::of(&two) {
        Some((number, _)) if number <= LAST && !is_hydrogen => two,
        _ => or(first.to_owned(), name),
    }
}

/// Returns the symbol if it is one of an element, else the name.
fn or(symbol: String, name: &str) -> String {
    match Element::of(&symbol) {
        Some(_) => symbol,
        None => name.to_owned(),
    }
}

fn letters(text: &str) -> String {
    text.chars().filter(char::is_ascii_alphabetic).collect()
}

fn is_any(all: &[&str], name: &str) -> bool {
    all.iter().any(|other| other.eq_ignore_ascii_case(name))
}

/// Returns true for a residue of a protein or a nucleic acid. The ends of chains have a letter before
/// it, as in `NALA`, or behind it, as in `DA5`.
fn is_polymer(residue: &str) -> bool {
    let all: Vec<_> = POLYMERS.split_ascii_whitespace().collect();
    let is_known = |name: &str| is_any(&all, name);
    let first = residue
        .strip_prefix(['N', 'C'])
        .filter(|name| name.len() == 3);
    let last = residue.strip_suffix(['3', '5', 'N']);
    is_known(residue) || first.is_some_and(is_known) || last.is_some_and(is_known)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_begin_with_elements() {
        for (name, residue, expected) in [
            // The standard: the element is right-aligned in two columns.
            (" CA ", "LYS", "C"),
            ("CA  ", "CA", "CA"),
            (" CA ", "CA", "CA"),
            ("FE  ", "HEM", "FE"),
            (" NA ", "HEM", "N"),
            ("HG11", "VAL", "H"),
            ("1HB ", "ALA", "H"),
            ("HO5'", "DA", "H"),
            // Aligned to the left, in residues whose elements are known.
            ("CA  ", "LYS", "C"),
            ("CD1 ", "LEU", "C"),
            ("CE  ", "NLYS", "C"),
            ("NE2 ", "HIE", "N"),
            ("HG  ", "SER", "H"),
            ("HE2 ", "GLU", "H"),
            ("SG  ", "CYX", "S"),
            ("SE  ", "MSE", "SE"),
            ("OS5'", "RA5", "O"),
            ("P   ", "DG", "P"),
            // Elsewhere, names of elements are taken for them.
            ("CL1 ", "LIG", "CL"),
            ("NH1 ", "LIG", "N"),
            ("OG12", "LIG", "O"),
            ("HW1 ", "SOL", "H"),
            ("OW  ", "SOL", "O"),
            (" D1 ", "DOD", "D"),
            (" I  ", "I", "I"),
            // Not elements.
            ("MW  ", "SOL", "MW"),
            (" EPW", "WAT", "EPW"),
            ("LP1 ", "CYS", "LP1"),
            (" Du ", "LIG", "Du"),
            (" X  ", "LIG", "X"),
            (" SOD", "SOD", "SOD"),
            ("    ", "", ""),
        ] {
            assert_eq!(symbol(name, residue), expected, "{name} {residue}");
        }
    }
}
