//! Full and read-only disks.

use std::process::Command;

use crate::support::{Done, Folder, has, run, skip};

/// Runs `script` with a small disk mounted at `disk`, in a separate namespace, so that the mount
/// goes away with it. Returns `None` if the system does not allow that.
fn on_disk(folder: &Folder, script: &str) -> Option<Done> {
    std::fs::create_dir(folder.path("disk")).unwrap();
    let mount = "mount -t tmpfs -o size=64k,nr_inodes=20 tmpfs disk";
    let unshare = |script: &str| {
        let mut shell = folder.shell("exec unshare -rm sh -c \"$SCRIPT\"");
        shell.env("SCRIPT", script);
        shell
    };
    if !has("unshare") || run(&mut unshare(mount)).status != Some(0) {
        skip("no disk can be mounted here");
        return None;
    }
    Some(run(&mut unshare(&format!("{mount} && {script}"))))
}

#[test]
fn a_full_disk_leaves_the_old_picture() {
    for (ending, options) in [("ppm", ""), ("bmp", ""), ("tiff", "--compression none")] {
        let folder = Folder::with_scenes();
        let script = format!(
            "echo old > disk/a.{ending}
            \"$STRAHL\" render scene.ron --size 400x300 {options} -o disk/a.{ending}
            status=$?
            [ \"$(cat disk/a.{ending})\" = old ] || echo the old picture is gone >&2
            [ \"$(ls -A disk)\" = a.{ending} ] || ls -A disk >&2
            exit $status"
        );
        let Some(done) = on_disk(&folder, &script) else {
            return;
        };
        done.one_line(75, &[&format!("disk/a.{ending}"), "space"]);
    }
}

#[test]
fn a_full_disk_gets_no_new_picture() {
    let folder = Folder::with_scenes();
    let script = "head -c 65536 /dev/zero > disk/filler
        \"$STRAHL\" render scene.ron -o disk/a.png
        status=$?
        [ \"$(ls -A disk)\" = filler ] || ls -A disk >&2
        exit $status";
    if let Some(done) = on_disk(&folder, script) {
        done.one_line(75, &["disk/a.png", "space"]);
    }
}

#[test]
fn a_disk_without_inodes_is_a_temporary_error() {
    let folder = Folder::with_scenes();
    let script = "for n in 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22; do
            touch disk/$n
        done 2>/dev/null
        exec \"$STRAHL\" render scene.ron -o disk/a.png";
    if let Some(done) = on_disk(&folder, script) {
        done.one_line(75, &["disk/a.png", "space"]);
    }
}

#[test]
fn a_full_disk_gets_no_manual() {
    let folder = Folder::new();
    let script = "head -c 65536 /dev/zero > disk/filler
        exec \"$STRAHL\" man disk";
    if let Some(done) = on_disk(&folder, script) {
        done.one_line(75, &["disk", "space"]);
    }
}

#[test]
fn a_read_only_disk_is_rejected() {
    let folder = Folder::with_scenes();
    let script = "echo old > disk/a.png
        mount -o remount,ro disk
        \"$STRAHL\" render scene.ron -o disk/a.png
        [ $? = 2 ] || echo status >&2
        [ \"$(cat disk/a.png)\" = old ] || echo the old picture is gone >&2
        \"$STRAHL\" render scene.ron -o disk/b.png
        [ $? = 2 ] || echo status >&2
        \"$STRAHL\" man disk/man
        exit $?";
    if let Some(done) = on_disk(&folder, script) {
        done.failure(
            2,
            &["disk/a.png: ", "disk/b.png: ", "disk/man: ", "read-only"],
        );
        assert_eq!(done.stderr.lines().count(), 3, "{}", done.stderr);
    }
}

#[test]
fn a_folder_without_permission_is_rejected() {
    let root = Command::new("id").arg("-u").output();
    if root.is_ok_and(|id| id.stdout == b"0\n") {
        return skip("permissions do not hold for root");
    }
    let folder = Folder::with_scenes();
    let script = "mkdir closed && chmod 500 closed
        \"$STRAHL\" render scene.ron -o closed/a.png
        status=$?
        chmod 700 closed && exit $status";
    run(&mut folder.shell(script)).one_line(2, &["closed/a.png", "permission denied"]);
    let script = "chmod 000 scene.ron && exec \"$STRAHL\" render scene.ron";
    run(&mut folder.shell(script)).one_line(2, &["scene.ron", "permission denied"]);
}
