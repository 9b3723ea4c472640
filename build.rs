//! Compresses the script of the page of `strahl preview`, which is part of the program.

use std::{env, error::Error, fs, path::Path};

/// The bundle, which `npm run build` writes.
const SCRIPT: &str = "src/cli/preview/page/built/page.js";
/// The level of compression, of 0 to 10.
const LEVEL: u8 = 9;

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed={SCRIPT}");
    if env::var_os("CARGO_FEATURE_PREVIEW").is_some() {
        let folder = env::var_os("OUT_DIR").ok_or("Cargo gives no OUT_DIR")?;
        let script = miniz_oxide::deflate::compress_to_vec_zlib(&fs::read(SCRIPT)?, LEVEL);
        fs::write(Path::new(&folder).join("page.js.zlib"), script)?;
    }
    Ok(())
}
