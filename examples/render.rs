//! Renders a scene file to a picture: the shortest use of the library.
//!
//! ```text
//! cargo run --example render -- scenes/gallery.ron gallery.png
//! ```

use std::{env, error::Error};

use strahl::Scene;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = env::args().skip(1).collect();
    let [scene, picture] = arguments.as_slice() else {
        return Err("expected a scene file and the name of a picture".into());
    };
    Scene::from_path(scene)?.save(picture)?;
    Ok(())
}
