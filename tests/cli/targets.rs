//! Valid and invalid output paths.

use std::fs;

use crate::support::{Folder, run};

#[test]
fn the_output_folder_must_exist() {
    let folder = Folder::with_scenes();
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "no/such/a.png"]));
    done.one_line(2, &["no/such/a.png", "no such"]);
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[test]
fn a_folder_is_not_an_output_file() {
    let folder = Folder::with_scenes();
    fs::create_dir(folder.path("a.png")).unwrap();
    fs::create_dir(folder.path("scene.png")).unwrap();
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"]));
    done.one_line(2, &["a.png", "folder"]);
    // A folder has the default name.
    let done = run(&mut folder.strahl(["render", "scene.ron"]));
    done.one_line(2, &["scene.png", "folder"]);
    assert_eq!(
        folder.names(),
        ["a.png", "scene.json", "scene.png", "scene.ron"]
    );
}

#[test]
fn an_unknown_extension_lists_the_known_ones() {
    let folder = Folder::with_scenes();
    for output in ["a.gif", "a.png.", "a", "a.", ".png", "a.png2", "scene.ron"] {
        let done = run(&mut folder.strahl(["render", "scene.ron", "-o", output]));
        let known = [
            ".png", ".jpg", ".jpeg", ".bmp", ".tiff", ".tif", ".ppm", ".qoi", ".webp",
        ];
        done.one_line(2, &[&[output], &known[..]].concat());
    }
    assert_eq!(folder.names(), ["scene.json", "scene.ron"]);
}

#[test]
fn an_old_picture_is_replaced_as_a_whole() {
    let folder = Folder::with_scenes();
    folder.write("a.png", vec![b'x'; 1_000_000]);
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"]));
    assert!(done.quiet_success().is_empty());
    let fresh = run(&mut folder.strahl(["render", "scene.ron", "-o", "-"])).quiet_success();
    assert!(fs::read(folder.path("a.png")).unwrap() == fresh);
    assert_eq!(folder.names(), ["a.png", "scene.json", "scene.ron"]);
}

#[test]
fn a_scene_with_errors_leaves_the_old_picture() {
    let folder = Folder::new();
    folder.write("bad.ron", "(camera: 5)");
    folder.write("bad.png", "old");
    run(&mut folder.strahl(["render", "bad.ron"])).bad_scene("bad.ron", &[]);
    assert_eq!(fs::read(folder.path("bad.png")).unwrap(), b"old");
    assert_eq!(folder.names(), ["bad.png", "bad.ron"]);
}

#[test]
fn a_write_protected_picture_is_left_alone() {
    let folder = Folder::with_scenes();
    let path = folder.write("a.png", "old");
    let mut permissions = fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    fs::set_permissions(&path, permissions.clone()).unwrap();
    let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"]));
    done.one_line(2, &["a.png"]);
    assert_eq!(fs::read(&path).unwrap(), b"old");
    assert_eq!(folder.names(), ["a.png", "scene.json", "scene.ron"]);
    #[cfg(windows)]
    {
        // The folder cannot be removed while it contains such a file.
        #[expect(
            clippy::permissions_set_readonly_false,
            reason = "elsewhere it would let everybody write"
        )]
        permissions.set_readonly(false);
        fs::set_permissions(&path, permissions).unwrap();
    }
}

#[cfg(unix)]
mod unix {
    use std::{
        fs::{self, Permissions},
        os::unix::fs::{FileTypeExt, PermissionsExt, symlink},
        path::Path,
        process::Command,
        thread,
    };

    use crate::support::{Folder, run, skip};

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).unwrap().permissions().mode() & 0o7777
    }

    #[test]
    fn an_old_picture_keeps_its_mode() {
        let folder = Folder::with_scenes();
        for bits in [0o640, 0o600, 0o666, 0o755] {
            let path = folder.write("a.png", "old");
            fs::set_permissions(&path, Permissions::from_mode(bits)).unwrap();
            run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"])).quiet_success();
            assert_eq!(mode(&path), bits);
            assert!(fs::read(&path).unwrap() != b"old");
        }
    }

    #[test]
    fn a_new_picture_has_the_default_mode() {
        let folder = Folder::with_scenes();
        for (umask, bits) in [
            ("022", 0o644),
            ("027", 0o640),
            ("000", 0o666),
            ("077", 0o600),
        ] {
            let script =
                format!("umask {umask} && exec \"$STRAHL\" render scene.ron -o {umask}.png");
            run(&mut folder.shell(&script)).quiet_success();
            assert_eq!(mode(&folder.path(format!("{umask}.png"))), bits, "{umask}");
        }
    }

    #[test]
    fn a_link_is_kept_and_its_target_is_written() {
        let folder = Folder::with_scenes();
        fs::create_dir(folder.path("deep")).unwrap();
        folder.write("deep/real.png", "old");
        fs::set_permissions(folder.path("deep/real.png"), Permissions::from_mode(0o640)).unwrap();
        symlink("deep/real.png", folder.path("one.png")).unwrap();
        symlink("one.png", folder.path("two.png")).unwrap();
        symlink("deep/new.png", folder.path("dangling.png")).unwrap();
        let expected = run(&mut folder.strahl(["render", "scene.ron", "-o", "-"]));
        let expected = expected.quiet_success();
        for (link, real) in [
            ("one.png", "deep/real.png"),
            ("two.png", "deep/real.png"),
            ("dangling.png", "deep/new.png"),
        ] {
            let done = run(&mut folder.strahl(["render", "scene.ron", "-o", link]));
            done.quiet_success();
            assert!(
                fs::symlink_metadata(folder.path(link))
                    .unwrap()
                    .is_symlink()
            );
            assert!(fs::symlink_metadata(folder.path(real)).unwrap().is_file());
            assert!(fs::read(folder.path(real)).unwrap() == expected, "{link}");
        }
        assert_eq!(mode(&folder.path("deep/real.png")), 0o640);
        assert_eq!(fs::read_dir(folder.path("deep")).unwrap().count(), 2);
    }

    #[test]
    fn a_cycle_of_links_is_rejected() {
        let folder = Folder::with_scenes();
        symlink("b.png", folder.path("a.png")).unwrap();
        symlink("a.png", folder.path("b.png")).unwrap();
        symlink("c.ron", folder.path("c.ron")).unwrap();
        let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "a.png"]));
        done.one_line(2, &["a.png", "link"]);
        run(&mut folder.strahl(["render", "c.ron"])).one_line(2, &["c.ron", "link"]);
    }

    #[test]
    fn a_device_is_written_through() {
        let folder = Folder::with_scenes();
        symlink("/dev/null", folder.path("null.png")).unwrap();
        run(&mut folder.strahl(["render", "scene.ron", "-o", "/dev/null"])).quiet_success();
        run(&mut folder.strahl(["render", "scene.ron", "-o", "null.png"])).quiet_success();
        assert!(
            fs::symlink_metadata(folder.path("null.png"))
                .unwrap()
                .is_symlink()
        );
        assert!(
            fs::metadata("/dev/null")
                .unwrap()
                .file_type()
                .is_char_device()
        );
    }

    #[test]
    fn a_full_device_is_a_temporary_error() {
        if !Path::new("/dev/full").exists() {
            return skip("there is no /dev/full");
        }
        let folder = Folder::with_scenes();
        for ending in ["png", "jpg", "bmp", "tiff", "ppm", "qoi", "webp"] {
            let link = format!("full.{ending}");
            symlink("/dev/full", folder.path(&link)).unwrap();
            let done = run(&mut folder.strahl(["render", "scene.ron", "-o", &link]));
            done.one_line(75, &[&link, "space"]);
            let script = format!(
                "exec \"$STRAHL\" render scene.ron -o - --image-format {ending} >/dev/full"
            );
            run(&mut folder.shell(&script)).one_line(75, &["<stdout>", "space"]);
        }
        assert!(
            fs::metadata("/dev/full")
                .unwrap()
                .file_type()
                .is_char_device()
        );
    }

    #[test]
    fn a_named_pipe_is_written_through() {
        let folder = Folder::with_scenes();
        let fifo = folder.path("fifo.png");
        let made = Command::new("mkfifo").arg(&fifo).status();
        if !made.is_ok_and(|status| status.success()) {
            return skip("there is no mkfifo");
        }
        let reader = thread::spawn(move || fs::read(fifo).unwrap());
        run(&mut folder.strahl(["render", "scene.ron", "-o", "fifo.png"])).quiet_success();
        let read = reader.join().unwrap();
        let expected = run(&mut folder.strahl(["render", "scene.ron", "-o", "-"]));
        assert!(read == expected.quiet_success());
        let kind = fs::symlink_metadata(folder.path("fifo.png"))
            .unwrap()
            .file_type();
        assert!(kind.is_fifo());
        assert_eq!(folder.names(), ["fifo.png", "scene.json", "scene.ron"]);
    }

    #[test]
    fn a_named_pipe_is_read_through_standard_input() {
        let folder = Folder::with_scenes();
        let fifo = folder.path("fifo.ron");
        let made = Command::new("mkfifo").arg(&fifo).status();
        if !made.is_ok_and(|status| status.success()) {
            return skip("there is no mkfifo");
        }
        // It may never get a writer.
        run(&mut folder.strahl(["render", "fifo.ron"])).one_line(2, &["fifo.ron", "named pipe"]);
        let writer = thread::spawn(move || fs::write(fifo, crate::support::RON).unwrap());
        let script = "cat fifo.ron | \"$STRAHL\" render - -o fifo.png";
        run(&mut folder.shell(script)).quiet_success();
        writer.join().unwrap();
        assert!(folder.path("fifo.png").is_file());
    }

    #[test]
    fn a_socket_is_not_an_output_file() {
        let folder = Folder::with_scenes();
        let _socket = std::os::unix::net::UnixListener::bind(folder.path("s.png")).unwrap();
        let done = run(&mut folder.strahl(["render", "scene.ron", "-o", "s.png"]));
        done.one_line(2, &["s.png"]);
    }
}
