"""What may lie where an output is to go: links, FIFOs, devices, read-only and full disks.

Devices and disks need a superuser on Linux; `LeftOut` is raised elsewhere.
"""

import contextlib
import os
import shutil
import stat
import subprocess
import tempfile
from collections.abc import Callable
from pathlib import Path

OLD = "old\n"
DISK = "size=4m"
Make = Callable[[Path], None]


class LeftOut(Exception):
    """Raised where this machine, or this user, does not allow the case."""


def link(path: Path) -> None:
    """Make a link to a file with old text."""
    target = path.with_name("target" + path.suffix)
    target.write_text(OLD)
    path.symlink_to(target.name)


def dangling(path: Path) -> None:
    """Make a link to what is not there."""
    path.symlink_to("target" + path.suffix)


def ring(path: Path) -> None:
    """Make two links that lead to each other."""
    path.symlink_to("other")
    path.with_name("other").symlink_to(path.name)


def device(path: Path) -> None:
    """Make a device that takes everything, as /dev/null does."""
    try:
        os.mknod(path, stat.S_IFCHR | 0o666, os.makedev(1, 3))
    except OSError as error:
        raise LeftOut(f"no device: {error.strerror}") from None


def file(path: Path) -> None:
    """Make a file with old text, a mode of its own and a second name."""
    path.write_text(OLD)
    path.chmod(0o640)
    path.with_name("second" + path.suffix).hardlink_to(path)


def folder(path: Path) -> None:
    """Make a folder with a file in it."""
    path.mkdir()
    (path / "mine").write_text(OLD)


def stream(path: Path) -> None:
    """Make a link to what this process has open, as /dev/stdout is one."""
    path.symlink_to("/dev/stdout")


def linked_folder(path: Path) -> None:
    """Make a link to an empty folder."""
    path.with_name("elsewhere").mkdir()
    path.symlink_to("elsewhere")


def inside(name: str, make: Make) -> Make:
    """Make something in a folder."""

    def made(path: Path) -> None:
        path.mkdir()
        make(path / name)

    return made


def read_only(path: Path) -> None:
    """Make a folder of its own on a disk that cannot be written."""
    _mount(path.parent)
    if not path.exists():
        path.write_text(OLD)
    _run("mount", "-o", "remount,ro", str(path.parent))


def full(path: Path) -> None:
    """Fill the disk that a file lies on."""
    _mount(path.parent)
    if not path.exists():
        path.write_text(OLD)
    _fill(path.parent)


def _fill(place: Path) -> None:
    with contextlib.suppress(OSError), (place / "filler").open("wb", buffering=0) as filler:
        while True:
            filler.write(bytes(4096))


def _mount(place: Path) -> None:
    """Put what lies in a folder onto a small disk of its own."""
    with tempfile.TemporaryDirectory() as kept:
        shutil.copytree(place, kept, symlinks=True, dirs_exist_ok=True)
        _run("mount", "-t", "tmpfs", "-o", DISK, "neuralgaits", str(place))
        shutil.copytree(kept, place, symlinks=True, dirs_exist_ok=True)


def _run(*words: str) -> None:
    if shutil.which(words[0]) is None or subprocess.run(words, capture_output=True).returncode:
        raise LeftOut(f"no {words[0]}")


def unmounted(area: Path) -> None:
    """Let go of disks in a folder, the inner ones first."""
    places = [path for path in area.rglob("*") if path.is_mount()]
    for place in sorted(places, key=lambda path: -len(path.parts)):
        subprocess.run(["umount", str(place)], check=True)
