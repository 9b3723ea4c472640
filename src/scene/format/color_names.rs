//! Colors as other programs write them, for fixes.

use std::str::FromStr;

/// Returns the bytes of an opaque color of CSS: a name, in either case, or a function.
pub(crate) fn of_css(text: &str) -> Option<[u8; 3]> {
    if let Some((bytes, is_opaque)) = of_function(text) {
        return is_opaque.then_some(bytes);
    }
    let name = text.to_ascii_lowercase().replace([' ', '_', '-'], "");
    let at = NAMES.binary_search_by_key(&&*name, |(name, _)| name).ok()?;
    let [_, r, g, b] = NAMES.get(at)?.1.to_be_bytes();
    Some([r, g, b])
}

/// Returns the bytes of a color such as `rgb(255, 128, 0)`, `rgba(100% 50% 0% / 0.5)` or `hsl(120, 50%, 50%)`,
/// and false if it is not opaque.
pub(crate) fn of_function(text: &str) -> Option<([u8; 3], bool)> {
    let (name, arguments) = text.strip_suffix(')')?.split_once('(')?;
    let arguments = arguments.split(|letter: char| ",/".contains(letter) || letter.is_whitespace());
    let arguments: Vec<_> = arguments.filter(|argument| !argument.is_empty()).collect();
    let (channels, alpha) = arguments.split_first_chunk()?;
    let is_opaque = match alpha {
        [] => true,
        [alpha] => fraction(alpha)? == 1.0,
        _ => return None,
    };
    let bytes = match name.to_ascii_lowercase().as_str() {
        "rgb" | "rgba" => of_rgb(*channels)?,
        "hsl" | "hsla" => of_hsl(*channels)?,
        _ => return None,
    };
    Some((bytes, is_opaque))
}

/// Returns a fraction, in 0..1 or as a percentage.
fn fraction(text: &str) -> Option<f64> {
    let number = match text.strip_suffix('%') {
        Some(percent) => f64::from_str(percent).ok()? / 100.0,
        None => f64::from_str(text).ok()?,
    };
    (0.0..=1.0).contains(&number).then_some(number)
}

fn byte(fraction: f64) -> u8 {
    (fraction * 255.0).round() as u8
}

/// Returns the color of three bytes or percentages. Numbers of which none is above 1 are probably in 0..1,
/// as in POV-Ray.
fn of_rgb(channels: [&str; 3]) -> Option<[u8; 3]> {
    let bytes = channels.map(|channel| u8::from_str(channel).ok());
    if let [Some(r), Some(g), Some(b)] = bytes {
        return [r, g, b].iter().any(|byte| *byte > 1).then_some([r, g, b]);
    }
    let are_percentages = channels.iter().all(|channel| channel.ends_with('%'));
    let [r, g, b] = channels.map(fraction);
    are_percentages.then_some([byte(r?), byte(g?), byte(b?)])
}

/// Returns the color of a hue in degrees, a saturation and a lightness: CSS Color Module Level 4, section 7.1.
fn of_hsl([hue, saturation, lightness]: [&str; 3]) -> Option<[u8; 3]> {
    let hue = f64::from_str(hue.strip_suffix("deg").unwrap_or(hue)).ok()?;
    let (saturation, lightness) = (fraction(saturation)?, fraction(lightness)?);
    let chroma = saturation * lightness.min(1.0 - lightness);
    let channel = |offset: f64| {
        let at = (offset + hue / 30.0).rem_euclid(12.0);
        byte(lightness - chroma * (at - 3.0).min(9.0 - at).clamp(-1.0, 1.0))
    };
    hue.is_finite().then(|| [0.0, 8.0, 4.0].map(channel))
}

/// Writes a color as `#rrggbb`.
pub(crate) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// The named colors of CSS Color Module Level 4, section 6.1, by name.
#[rustfmt::skip]
const NAMES: &[(&str, u32)] = &[
    ("aliceblue", 0xf0f8ff), ("antiquewhite", 0xfaebd7), ("aqua", 0x00ffff), ("aquamarine", 0x7fffd4),
    ("azure", 0xf0ffff), ("beige", 0xf5f5dc), ("bisque", 0xffe4c4), ("black", 0x000000),
    ("blanchedalmond", 0xffebcd), ("blue", 0x0000ff), ("blueviolet", 0x8a2be2), ("brown", 0xa52a2a),
    ("burlywood", 0xdeb887), ("cadetblue", 0x5f9ea0), ("chartreuse", 0x7fff00), ("chocolate", 0xd2691e),
    ("coral", 0xff7f50), ("cornflowerblue", 0x6495ed), ("cornsilk", 0xfff8dc), ("crimson", 0xdc143c),
    ("cyan", 0x00ffff), ("darkblue", 0x00008b), ("darkcyan", 0x008b8b), ("darkgoldenrod", 0xb8860b),
    ("darkgray", 0xa9a9a9), ("darkgreen", 0x006400), ("darkgrey", 0xa9a9a9), ("darkkhaki", 0xbdb76b),
    ("darkmagenta", 0x8b008b), ("darkolivegreen", 0x556b2f), ("darkorange", 0xff8c00), ("darkorchid", 0x9932cc),
    ("darkred", 0x8b0000), ("darksalmon", 0xe9967a), ("darkseagreen", 0x8fbc8f), ("darkslateblue", 0x483d8b),
    ("darkslategray", 0x2f4f4f), ("darkslategrey", 0x2f4f4f), ("darkturquoise", 0x00ced1), ("darkviolet", 0x9400d3),
    ("deeppink", 0xff1493), ("deepskyblue", 0x00bfff), ("dimgray", 0x696969), ("dimgrey", 0x696969),
    ("dodgerblue", 0x1e90ff), ("firebrick", 0xb22222), ("floralwhite", 0xfffaf0), ("forestgreen", 0x228b22),
    ("fuchsia", 0xff00ff), ("gainsboro", 0xdcdcdc), ("ghostwhite", 0xf8f8ff), ("gold", 0xffd700),
    ("goldenrod", 0xdaa520), ("gray", 0x808080), ("green", 0x008000), ("greenyellow", 0xadff2f),
    ("grey", 0x808080), ("honeydew", 0xf0fff0), ("hotpink", 0xff69b4), ("indianred", 0xcd5c5c),
    ("indigo", 0x4b0082), ("ivory", 0xfffff0), ("khaki", 0xf0e68c), ("lavender", 0xe6e6fa),
    ("lavenderblush", 0xfff0f5), ("lawngreen", 0x7cfc00), ("lemonchiffon", 0xfffacd), ("lightblue", 0xadd8e6),
    ("lightcoral", 0xf08080), ("lightcyan", 0xe0ffff), ("lightgoldenrodyellow", 0xfafad2), ("lightgray", 0xd3d3d3),
    ("lightgreen", 0x90ee90), ("lightgrey", 0xd3d3d3), ("lightpink", 0xffb6c1), ("lightsalmon", 0xffa07a),
    ("lightseagreen", 0x20b2aa), ("lightskyblue", 0x87cefa), ("lightslategray", 0x778899), ("lightslategrey", 0x778899),
    ("lightsteelblue", 0xb0c4de), ("lightyellow", 0xffffe0), ("lime", 0x00ff00), ("limegreen", 0x32cd32),
    ("linen", 0xfaf0e6), ("magenta", 0xff00ff), ("maroon", 0x800000), ("mediumaquamarine", 0x66cdaa),
    ("mediumblue", 0x0000cd), ("mediumorchid", 0xba55d3), ("mediumpurple", 0x9370db), ("mediumseagreen", 0x3cb371),
    ("mediumslateblue", 0x7b68ee), ("mediumspringgreen", 0x00fa9a), ("mediumturquoise", 0x48d1cc), ("mediumvioletred", 0xc71585),
    ("midnightblue", 0x191970), ("mintcream", 0xf5fffa), ("mistyrose", 0xffe4e1), ("moccasin", 0xffe4b5),
    ("navajowhite", 0xffdead), ("navy", 0x000080), ("oldlace", 0xfdf5e6), ("olive", 0x808000),
    ("olivedrab", 0x6b8e23), ("orange", 0xffa500), ("orangered", 0xff4500), ("orchid", 0xda70d6),
    ("palegoldenrod", 0xeee8aa), ("palegreen", 0x98fb98), ("paleturquoise", 0xafeeee), ("palevioletred", 0xdb7093),
    ("papayawhip", 0xffefd5), ("peachpuff", 0xffdab9), ("peru", 0xcd853f), ("pink", 0xffc0cb),
    ("plum", 0xdda0dd), ("powderblue", 0xb0e0e6), ("purple", 0x800080), ("rebeccapurple", 0x663399),
    ("red", 0xff0000), ("rosybrown", 0xbc8f8f), ("royalblue", 0x4169e1), ("saddlebrown", 0x8b4513),
    ("salmon", 0xfa8072), ("sandybrown", 0xf4a460), ("seagreen", 0x2e8b57), ("seashell", 0xfff5ee),
    ("sienna", 0xa0522d), ("silver", 0xc0c0c0), ("skyblue", 0x87ceeb), ("slateblue", 0x6a5acd),
    ("slategray", 0x708090), ("slategrey", 0x708090), ("snow", 0xfffafa), ("springgreen", 0x00ff7f),
    ("steelblue", 0x4682b4), ("tan", 0xd2b48c), ("teal", 0x008080), ("thistle", 0xd8bfd8),
    ("tomato", 0xff6347), ("turquoise", 0x40e0d0), ("violet", 0xee82ee), ("wheat", 0xf5deb3),
    ("white", 0xffffff), ("whitesmoke", 0xf5f5f5), ("yellow", 0xffff00), ("yellowgreen", 0x9acd32),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_of_css_are_known() {
        assert!(NAMES.is_sorted_by_key(|(name, _)| name));
        for (text, color) in [
            ("red", Some([255, 0, 0])),
            ("Orange", Some([255, 165, 0])),
            ("Light Blue", Some([173, 216, 230])),
            ("yellowgreen", Some([154, 205, 50])),
            ("rgb(255, 128,0)", Some([255, 128, 0])),
            ("rgb(256, 0, 0)", None),
            ("rgb(1, 0, 0)", None),
            ("rgb(0.5, 0, 0)", None),
            ("rgb(1, 2)", None),
            ("rgb(255 128 0)", Some([255, 128, 0])),
            ("rgb(100%, 50%, 0%)", Some([255, 128, 0])),
            ("rgb(100%, 128, 0%)", None),
            ("rgba(255, 128, 0, 1)", Some([255, 128, 0])),
            ("rgba(255, 128, 0, 0.5)", None),
            ("rgb(255 128 0 / 100%)", Some([255, 128, 0])),
            // As browsers compute them.
            ("hsl(120, 50%, 50%)", Some([64, 191, 64])),
            ("hsl(120, 0.5, 0.5)", Some([64, 191, 64])),
            ("HSL(-30deg 100% 25%)", Some([128, 0, 64])),
            ("hsl(0, 0%, 100%)", Some([255, 255, 255])),
            ("hsl(720, 100%, 50%)", Some([255, 0, 0])),
            ("hsla(0, 100%, 50%, 0.2)", None),
            ("hsl(nan, 50%, 50%)", None),
            ("hsl(inf, 50%, 50%)", None),
            ("hsl(0, 150%, 50%)", None),
            ("hwb(0, 0%, 0%)", None),
            ("reddish", None),
            ("", None),
        ] {
            assert_eq!(of_css(text), color, "{text}");
        }
    }
}
