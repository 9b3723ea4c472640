//! Malicious files: false sizes, endless inputs, folders of other users.

use crate::support::{Done, Folder, run};

/// Runs the program with at most this many KiB of memory.
pub(crate) fn with_memory(folder: &Folder, kib: u32, args: &[&str]) -> Done {
    let script = format!("ulimit -v {kib}; exec \"$STRAHL\" \"$@\"");
    run(folder.shell(&script).arg("strahl").args(args))
}

/// Memory limit in KiB: enough for the program, but not for what an attack requests.
const LITTLE: u32 = 400_000;

fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let mut png = (data.len() as u32).to_be_bytes().to_vec();
    let mut body = kind.to_vec();
    body.extend(data);
    png.extend(&body);
    png.extend(crc(&body).to_be_bytes());
    png
}

fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            (crc >> 1) ^ (0xedb8_8320 * (crc & 1))
        })
    };
    !bytes.iter().fold(!0, step)
}

fn png(width: u32, height: u32) -> Vec<u8> {
    let mut png = b"\x89PNG\r\n\x1a\n".to_vec();
    let mut head = width.to_be_bytes().to_vec();
    head.extend(height.to_be_bytes());
    head.extend([8, 2, 0, 0, 0]);
    png.extend(chunk(b"IHDR", &head));
    png.extend(chunk(b"IDAT", &[0x78, 0x9c, 0x63, 0, 0, 0, 1, 0, 1]));
    png.extend(chunk(b"IEND", &[]));
    png
}

fn jpeg(side: u16) -> Vec<u8> {
    let [high, low] = side.to_be_bytes();
    let mut jpeg = vec![0xff, 0xd8, 0xff, 0xdb, 0, 67, 0];
    jpeg.extend([1; 64]);
    jpeg.extend([0xff, 0xc0, 0, 17, 8, high, low, high, low, 3]);
    jpeg.extend([1, 0x11, 0, 2, 0x11, 0, 3, 0x11, 0]);
    jpeg.extend([0xff, 0xda, 0, 12, 3, 1, 0, 2, 0, 3, 0, 0, 63, 0]);
    jpeg.resize(1000, 0);
    jpeg.extend([0xff, 0xd9]);
    jpeg
}

fn riff(chunks: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut body = b"WEBP".to_vec();
    for (kind, data) in chunks {
        body.extend(*kind);
        body.extend((data.len() as u32).to_le_bytes());
        body.extend(data);
        body.resize(body.len().next_multiple_of(2), 0);
    }
    let mut webp = b"RIFF".to_vec();
    webp.extend((body.len() as u32).to_le_bytes());
    webp.extend(body);
    webp
}

/// Returns a canvas of these sides, less than 2^24 each.
fn vp8x(width: u32, height: u32) -> Vec<u8> {
    let mut data = vec![0; 4];
    data.extend(&(width - 1).to_le_bytes()[..3]);
    data.extend(&(height - 1).to_le_bytes()[..3]);
    data
}

/// Returns the header of a lossy frame of these sides.
fn vp8(width: u16, height: u16) -> Vec<u8> {
    let mut data = vec![0x10, 0x02, 0, 0x9d, 0x01, 0x2a];
    data.extend(width.to_le_bytes());
    data.extend(height.to_le_bytes());
    data.extend([0; 32]);
    data
}

fn tiff(width: u32, height: u32, bits: u32, kind: u32) -> Vec<u8> {
    let mut tiff = b"II*\0\x08\0\0\0".to_vec();
    let entries = [
        (256, width),
        (257, height),
        (258, bits),
        (259, 1),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, height),
        (279, width),
        (339, kind),
    ];
    tiff.extend((entries.len() as u16).to_le_bytes());
    for (tag, value) in entries {
        tiff.extend((tag as u16).to_le_bytes());
        tiff.extend([4, 0, 1, 0, 0, 0]);
        tiff.extend(value.to_le_bytes());
    }
    tiff.extend([0; 4]);
    tiff
}

/// Returns a header whose windows end at these corners, without pixels.
fn exr(data: [i32; 4], display: [i32; 4]) -> Vec<u8> {
    let mut exr = vec![0x76, 0x2f, 0x31, 0x01, 2, 0, 0, 0];
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        exr.extend(name.bytes().chain([0]).chain(kind.bytes()).chain([0]));
        exr.extend((value.len() as u32).to_le_bytes());
        exr.extend(value);
    };
    let window = |corners: [i32; 4]| corners.map(i32::to_le_bytes).concat();
    let mut channels = Vec::new();
    for name in [b'A', b'B', b'G', b'R'] {
        channels.extend([name, 0, 2, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]);
    }
    channels.push(0);
    attribute("channels", "chlist", &channels);
    attribute("compression", "compression", &[3]);
    attribute("dataWindow", "box2i", &window(data));
    attribute("displayWindow", "box2i", &window(display));
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1_f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1_f32.to_le_bytes());
    exr.push(0);
    exr.resize(520, 0);
    exr
}

fn bmp(width: u32, height: u32) -> Vec<u8> {
    let mut bmp = b"BM\x46\0\0\0\0\0\0\0\x36\0\0\0\x28\0\0\0".to_vec();
    bmp.extend(width.to_le_bytes());
    bmp.extend(height.to_le_bytes());
    bmp.extend([1, 0, 24, 0]);
    bmp.resize(70, 0);
    bmp
}

fn qoi(width: u32, height: u32) -> Vec<u8> {
    let mut qoi = b"qoif".to_vec();
    qoi.extend(width.to_be_bytes());
    qoi.extend(height.to_be_bytes());
    qoi.extend([3, 0, 0xc0, 0, 0, 0, 0, 0, 0, 0, 1]);
    qoi
}

#[test]
fn a_size_beyond_the_limit_is_rejected_before_allocation() {
    let folder = Folder::new();
    folder.write("small.ppm", b"P6 1 1 255 rgb");
    let small = [0, 0, 7, 7];
    for (name, bytes, size) in [
        ("png", png(100_000, 100_000), "100000x100000"),
        ("jpg", jpeg(65_535), "65535x65535"),
        ("gray.tiff", tiff(90_000, 90_000, 8, 1), "90000x90000"),
        ("float.tiff", tiff(90_000, 90_000, 32, 3), "90000x90000"),
        ("bmp", bmp(60_000, 60_000), "60000x60000"),
        ("qoi", qoi(20_000, 15_000), "20000x15000"),
        ("ppm", b"P6 90000 90000 255 ".to_vec(), "90000x90000"),
        ("pgm", b"P5 90000 90000 255 ".to_vec(), "90000x90000"),
        ("pfm", b"PF\n90000 90000\n-1\n".to_vec(), "90000x90000"),
        (
            "hdr",
            b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 90000 +X 90000\n".to_vec(),
            "90000x90000",
        ),
        (
            "canvas.webp",
            riff(&[(b"VP8X", vp8x(20_000, 20_000)), (b"VP8 ", vp8(9, 9))]),
            "20000x20000",
        ),
        (
            "data.exr",
            exr([0, 0, 99_999, 89_999], small),
            "100000x90000",
        ),
        (
            "display.exr",
            exr(small, [0, 0, 99_999, 89_999]),
            "100000x90000",
        ),
    ] {
        folder.write(name, bytes);
        for pair in [[name, "small.ppm"], ["small.ppm", name]] {
            let done = with_memory(&folder, LITTLE, &["diff", pair[0], pair[1]]);
            done.one_line(2, &[name, size, "268435456", "--max-pixels"]);
        }
    }
    // Sides beyond an i32, for either window.
    let far = [i32::MIN, 0, i32::MAX - 1, 7];
    for windows in [[far, small], [small, far]] {
        folder.write("far.exr", exr(windows[0], windows[1]));
        let done = with_memory(&folder, LITTLE, &["diff", "far.exr", "small.ppm"]);
        done.one_line(2, &["far.exr", "window"]);
    }
}

#[test]
fn a_frame_larger_than_its_canvas_counts() {
    let folder = Folder::new();
    let chunks = [(b"VP8X", vp8x(4, 4)), (b"VP8 ", vp8(16_383, 16_383))];
    folder.write("a.webp", riff(&chunks));
    let args = ["diff", "a.webp", "a.webp", "--max-pixels", "1000000"];
    with_memory(&folder, LITTLE, &args).one_line(2, &["a.webp", "16383x16383"]);
}

#[test]
fn max_pixels_sets_the_limit() {
    let folder = Folder::new();
    folder.write("a.png", png(30, 20));
    let done = run(&mut folder.strahl(["diff", "a.png", "a.png", "--max-pixels", "599"]));
    done.one_line(2, &["a.png", "30x20", "599"]);
    folder.write("b.ppm", [&b"P6 3 2 255 "[..], &[7; 18]].concat());
    let done = run(&mut folder.strahl(["diff", "b.ppm", "b.ppm", "--max-pixels", "6"]));
    done.quiet_success();
}

#[test]
fn a_size_within_the_limit_and_no_pixels_is_an_error() {
    let folder = Folder::new();
    for (name, bytes) in [
        ("png", png(16_000, 16_000)),
        ("tiff", tiff(16_000, 16_000, 8, 1)),
        ("qoi", qoi(16_000, 16_000)),
        ("exr", exr([0, 0, 999, 999], [0, 0, 999, 999])),
        (
            "webp",
            riff(&[(b"VP8X", vp8x(999, 999)), (b"VP8 ", vp8(999, 999))]),
        ),
    ] {
        folder.write(name, bytes);
        run(&mut folder.strahl(["diff", name, name])).failure(2, &[name]);
    }
}

#[test]
fn the_decompressed_size_of_a_profile_is_bounded() {
    let folder = Folder::new();
    let mut png = png(1, 1);
    // 200 MB of text, compressed to 200 kB.
    let mut text = b"Comment\0\0".to_vec();
    text.extend(deflated_zeros());
    let end = png.len() - 12;
    let tail = png.split_off(33);
    png.extend(chunk(b"iCCP", &text));
    png.extend(tail);
    assert!(png.len() > end);
    folder.write("a.png", png);
    let done = with_memory(&folder, LITTLE, &["diff", "a.png", "a.png"]);
    assert!(matches!(done.status, Some(0 | 2)), "{done:?}");
    done.no_panic();
}

fn deflated_zeros() -> Vec<u8> {
    miniz_oxide::deflate::compress_to_vec_zlib(&vec![0; 200_000_000], 6)
}

#[cfg(target_os = "linux")]
#[test]
fn a_sky_that_does_not_fit_into_memory_is_an_error() {
    let folder = Folder::new();
    let mut sky = b"Pf 3000 2000 -1 ".to_vec();
    sky.resize(sky.len() + 4 * 3000 * 2000, 0);
    folder.write("sky.pfm", sky);
    folder.write(
        "sky.ron",
        "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4), lighting: Path(), \
         lights: [Environment(image: \"sky.pfm\")], \
         geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")])",
    );
    // The file, its samples, their light and the table of the sky need 24, 24, 72 and 48 MB.
    let mut is_read = Vec::new();
    for kib in (200_000..400_000).step_by(12_000).chain([2_000_000]) {
        let done = with_memory(&folder, kib, &["validate", "sky.ron"]);
        let text = String::from_utf8_lossy(&done.stdout);
        let is_full = text.contains("a picture of 3000x2000 does not fit into memory");
        assert_eq!(done.status, Some(1), "{kib} {done:?}");
        assert!(
            is_full != text.contains("the picture is black"),
            "{kib} {text}"
        );
        is_read.push(!is_full);
    }
    assert!(!is_read[0] && is_read.ends_with(&[true]), "{is_read:?}");
}

#[test]
fn devices_and_endless_pipes_are_not_pictures() {
    let folder = Folder::new();
    folder.write("a.png", png(1, 1));
    for device in ["/dev/zero", "/dev/null"] {
        let done = with_memory(&folder, LITTLE, &["diff", device, "a.png"]);
        done.one_line(2, &[device, "is a device, not a file"]);
    }
    let script = "ulimit -v 400000; yes | \"$STRAHL\" diff /dev/stdin a.png --max-pixels 1000";
    run(&mut folder.shell(script)).one_line(2, &["/dev/stdin", "is longer than"]);
    let script = "\"$STRAHL\" diff /dev/stdin b.ppm < b.ppm && cat b.ppm | \"$STRAHL\" diff /dev/stdin b.ppm";
    folder.write("b.ppm", [&b"P6 3 2 255 "[..], &[7; 18]].concat());
    run(&mut folder.shell(script)).quiet_success();
}

#[test]
#[cfg(unix)]
fn named_pipes_are_not_opened() {
    let folder = Folder::with_scenes();
    run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"])).quiet_success();
    let made = std::process::Command::new("mkfifo")
        .arg(folder.path("pipe.png"))
        .status();
    if !made.is_ok_and(|status| status.success()) {
        return crate::support::skip("there is no mkfifo");
    }
    run(&mut folder.strahl(["diff", "pipe.png", "a.png"])).one_line(2, &["pipe.png", "named pipe"]);
    let mut same = folder.shell("\"$STRAHL\" diff . . > log");
    assert_eq!(run(&mut same).status, Some(0));
}

/// Returns the peak memory of a run in bytes, by GNU `time`.
fn peak_memory(folder: &Folder, args: &[&str]) -> usize {
    let script = "exec /usr/bin/time -q -f %M -o peak \"$STRAHL\" \"$@\" > log 2> faults";
    run(folder.shell(script).arg("strahl").args(args));
    let peak = std::fs::read_to_string(folder.path("peak")).unwrap();
    peak.trim().parse::<usize>().unwrap() * 1024
}

#[test]
fn a_faulty_scene_takes_at_most_thirty_times_its_size_in_memory() {
    const COUNT: usize = 100_000;
    if !crate::support::has("/usr/bin/time") {
        return crate::support::skip("there is no /usr/bin/time");
    }
    let folder = Folder::with_scenes();
    let program = peak_memory(&folder, &["info", "scene.ron"]);
    let list = |item: &str| {
        let items = item.repeat(COUNT);
        format!("{{\"camera\":1,\"geometries\":[{items}1]}}")
    };
    let scenes = [
        ("ones.json", list("1,")),
        ("lines.json", list("1,\n")),
        ("brackets.json", "[".repeat(8 * COUNT)),
        ("brackets.ron", "(".repeat(8 * COUNT)),
        ("keys.json", format!("{{{}a:1}}", "a:1,".repeat(2 * COUNT))),
        (
            "cameras.ron",
            format!("({}camera:1)", "camera:1,".repeat(COUNT)),
        ),
    ];
    for (name, text) in scenes {
        folder.write(name, &text);
        for args in [
            &["validate", name][..],
            &["validate", "--diff", name],
            &["fmt", "--check", name],
            &["fmt", "--diff", name],
        ] {
            let most = program + 30 * text.len();
            let peak = peak_memory(&folder, args);
            assert!(peak <= most, "{args:?}: {peak}, at most {most}");
        }
    }
}

#[cfg(target_os = "linux")]
#[test]
fn outlines_that_would_take_hours_are_refused() {
    let folder = Folder::new();
    let scene = |fields: &str| {
        format!(
            "(camera: Orthographic(eye: (0, 0, 9), gaze: (0, 0, -1), scale: 4), \
             image: (width: 640, height: 480, samples: 4096), {fields}, \
             geometries: [Sphere(center: (0, 0, 0), radius: 1, color: \"#f00\")])"
        )
    };
    folder.write("wide.ron", scene("outlines: (width: 100)"));
    folder.write("bent.ron", scene("outlines: (width: 60, creases: 30)"));
    for name in ["wide.ron", "bent.ron"] {
        for args in [&["render", name][..], &["pixel", name, "0,0"]] {
            let done = with_memory(&folder, 2_000_000, args);
            done.one_line(
                75,
                &["samples wide would take too long, the maximum is 640"],
            );
        }
    }
    assert_eq!(folder.names(), ["bent.ron", "wide.ron"]);
    // The widest that is drawn.
    folder.write("fits.ron", scene("outlines: (width: 10)"));
    let done = with_memory(&folder, 2_000_000, &["pixel", "fits.ron", "320,240"]);
    assert_eq!((done.status, &*done.stderr), (Some(0), ""));
}
