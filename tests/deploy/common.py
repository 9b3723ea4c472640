"""Helpers for the checks of `deploy/`: scenes, the commands of a page, comparison of pictures."""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
DEPLOY = ROOT / "deploy"


def expect(right, what):
    if not right:
        sys.exit(f"wrong: {what}")


def skip(why):
    print(f"skipped: {why}")
    sys.exit(0)


def write_scenes(folder, count, width, height):
    """Writes the gallery, seen from `count` positions."""
    text = (ROOT / "scenes/gallery.ron").read_text()
    text = text.replace("width: 960, height: 540", f"width: {width}, height: {height}")
    folder.mkdir()
    for number in range(count):
        scene = text.replace("eye: (0, 4, 15)", f"eye: ({number / 16}, 4, 15)")
        expect(scene != text or number == 0, "the eye of scenes/gallery.ron is where it was")
        (folder / f"view-{number:04}.ron").write_text(scene)


def commands(page, heading):
    """Returns the first block of commands below a heading of a page of `deploy/`."""
    text = (DEPLOY / page).read_text()
    section = re.search(rf"^## {re.escape(heading)}\n(.*?)(?=^## |\Z)", text, re.M | re.S)
    expect(section, f"deploy/{page} has a section `{heading}`")
    block = re.search(r"^```sh\n(.*?)^```$", section[1], re.M | re.S)
    expect(block, f"the section `{heading}` of deploy/{page} has commands")
    return block[1]


def bash(script, environment, folder):
    """Runs commands of a page, with the output of the check."""
    print(script.rstrip(), flush=True)
    return subprocess.run(
        ["bash", "-euo", "pipefail", "-c", script], env=environment, cwd=folder
    ).returncode


def drawing():
    """Returns the processes that are rendering a shard."""
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            words = (process / "cmdline").read_bytes().split(b"\0")
            if any(re.fullmatch(rb"\d+/\d+", shard) for shard in after(words, b"--shard")):
                yield int(process.name)


def after(words, word):
    return [second for first, second in zip(words, words[1:]) if first == word]


def visible(folder):
    return sorted(path.name for path in folder.iterdir() if path.name[0] != ".")


def same_pictures(found, expected):
    """Checks that both folders have the same files with the same bytes."""
    expect(visible(expected), f"there are pictures in {expected}")
    expect(visible(found) == visible(expected), f"{visible(found)}, expected {visible(expected)}")
    for name in visible(expected):
        same = (found / name).read_bytes() == (expected / name).read_bytes()
        expect(same, f"{name} has the bytes that one process makes")


class Work:
    """A folder with a run: `scenes/`, and `expected/` as rendered by one process."""

    def __init__(self, folder, strahl, count, width, height):
        self.folder = pathlib.Path(folder)
        self.scenes = self.folder / "scenes"
        self.expected = self.folder / "expected"
        self.pictures = self.folder / "pictures"
        programs = self.folder / "bin"
        programs.mkdir()
        (programs / "strahl").symlink_to(strahl)
        self.environment = os.environ | {"PATH": f"{programs}:{os.environ['PATH']}"}
        write_scenes(self.scenes, count, width, height)
        self.strahl("render", "scenes", "-o", "expected/", "--quiet")

    def strahl(self, *arguments):
        command = ["strahl", *arguments]
        done = subprocess.run(command, env=self.environment, cwd=self.folder)
        expect(done.returncode == 0, f"{command} ends with {done.returncode}")

    def complete(self):
        """Checks that the run is complete, by its record and byte for byte."""
        self.strahl("status", "pictures")
        same_pictures(self.pictures, self.expected)
        hidden = {path.name for path in self.pictures.iterdir() if path.name[0] == "."}
        if left := sorted(hidden - {".strahl"}):
            print("left behind by those that were killed:", *left)


@contextlib.contextmanager
def work(count=12, width=320, height=180):
    """Creates a run for the `strahl` in the argument of the check."""
    if len(sys.argv) != 2:
        sys.exit(f"usage: {pathlib.Path(sys.argv[0]).name} STRAHL")
    strahl = pathlib.Path(sys.argv[1]).resolve()
    expect(os.access(strahl, os.X_OK), f"{strahl} is a program")
    # As an exception, so that everything started is cleaned up.
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    with tempfile.TemporaryDirectory(prefix="strahl-deploy-") as folder:
        # Other processes, such as a daemon with its own name, are ignored.
        os.chmod(folder, 0o711)
        yield Work(folder, strahl, count, width, height)
