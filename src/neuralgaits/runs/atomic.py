"""Files that appear whole or not at all.

An output is a regular file. A symbolic link is followed: its target is made or replaced, and the
link stays. A path that is no regular file (a folder, a device, a FIFO, a socket, an open stream as
/dev/stdout) is refused, never written to and never replaced. A file that is replaced keeps its
permissions, and its owner where the system allows it; another name of it, a hard link, keeps the
old content. `runs.outputs` refuses a second name of a run's own file.
"""

import contextlib
import errno
import os
import stat
import tempfile
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

from neuralgaits._inputs import kind_of
from neuralgaits._printable import PRINTABLE
from neuralgaits.errors import InputError, reason

_MASK = threading.Lock()
"""Lock, since two threads that set and restore the mask could leave the value of one of them."""
_NAME, _MOVE = "name a regular file", "move it away"
"""Remedies for a place that is taken: of a user who named it, and of one who named none."""
_EITHER = f"{_MOVE}, or {_NAME}"


def destination(path: Path, remedy: str = _EITHER) -> Path:
    """Return the file that is made or replaced where a path is written: links are followed.

    Args:
        path: path of the file.
        remedy: advice if something else is in its place.

    Raises: InputError on anything but a regular file; OSError if the system refuses to look.
    """
    place = path
    # Links below this folder lead to files that a process has open, whatever their names say.
    streams = Path("/proc")
    # Linux follows as many links, and no more.
    for _ in range(40):
        folder = Path(os.path.realpath(place.parent))
        if folder.is_relative_to(streams):
            if folder.name == "fd":
                raise InputError(
                    f"expected a file to write, found an open stream at {path}: {remedy}"
                )
            raise InputError(
                f"expected a folder to write to, found {path.parent}, which is the system's own: "
                "name a folder of yours"
            )
        place = folder / place.name
        if not place.is_symlink():
            break
        place = folder / os.readlink(place)
    else:
        raise InputError(f"expected a file to write, found links in a ring at {path}: {remedy}")
    with contextlib.suppress(FileNotFoundError):
        mode = os.stat(place).st_mode
        if not stat.S_ISREG(mode):
            kind = kind_of(mode)
            raise InputError(f"expected a file to write, found {kind} at {path}: {remedy}")
    return place


def folder_destination(path: Path) -> Path:
    """Return the folder that is made or filled where a path names one: links are followed.

    Raises: InputError on anything but a folder, or on a ring of links.
    """
    place = Path(os.path.realpath(path))
    try:
        mode = os.stat(place).st_mode
    except FileNotFoundError:
        return place
    except OSError as error:
        raise InputError(
            f"expected a folder to write to, found {path}: {reason(error)}; name another"
        ) from None
    if not stat.S_ISDIR(mode):
        raise InputError(f"expected a folder to write to, found a file at {path}: name another")
    return place


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file so that a reader, or a power cut, meets the old or the new content only.

    Raises: as `write_together`.
    """
    write_together({path: data})


def write_text(path: Path, text: str) -> None:
    """Write a UTF-8 text file whole or not at all. Raises: as `write_together`."""
    write_bytes(path, text.encode("utf-8", PRINTABLE))


def write_together(files: Mapping[Path, bytes | None], *, clear: bool = False) -> None:
    """Write files that belong together: none is touched before all are on disk.

    The data go to temporary files beside their destinations, which are then renamed in order; what
    is to be gone is removed last. A failure leaves all old files, and only a kill between two
    renames leaves some of each.

    Args:
        files: content by path; None removes the file, or a link to it.
        clear: remove all old files before the first is renamed, so that a kill in between leaves
            fewer files and never a mixture.

    Raises: InputError if a path is no place for a regular file, OSError with that path if the
        system refuses: then everything is as it was.
    """
    texts = {}
    for path in files:
        with _blamed_on(path):
            texts[path] = destination(path)
    with contextlib.ExitStack() as staged:
        temporaries = {
            path: staged.enter_context(_on_disk(path, texts[path], data))
            for path, data in files.items()
            if data is not None
        }
        for path in temporaries if clear else ():
            texts[path].unlink(missing_ok=True)
        for path, temporary in temporaries.items():
            with _blamed_on(path):
                temporary.replace(texts[path])
        for path in files.keys() - temporaries.keys():
            path.unlink(missing_ok=True)
    for folder in {texts[path].parent for path in temporaries}:
        _sync_folder(folder)


@contextlib.contextmanager
def _on_disk(path: Path, place: Path, data: bytes) -> Iterator[Path]:
    """Hold a temporary file with the data beside its destination, and remove it afterwards."""
    with _blamed_on(path):
        place.parent.mkdir(parents=True, exist_ok=True)
        # Only its beginning: a name may be as long as the system allows.
        prefix = f".{place.name[:40]}."
        handle, name = tempfile.mkstemp(dir=place.parent, prefix=prefix, suffix=".tmp")
    temporary = Path(name)
    try:
        with _blamed_on(path):
            with os.fdopen(handle, "wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            _take_permissions(temporary, place)
        yield temporary
    finally:
        temporary.unlink(missing_ok=True)


@contextlib.contextmanager
def _blamed_on(path: Path) -> Iterator[None]:
    """Name the destination file in an error of the system about its temporary."""
    try:
        yield
    except OSError as error:
        raise OSError(error.errno, error.strerror, str(path)) from error


def _take_permissions(temporary: Path, place: Path) -> None:
    """Give a new file the permissions of the file it replaces, or those of any new file."""
    try:
        old = place.stat()
    except FileNotFoundError:
        # mkstemp keeps others out; a run is as readable as any file of its user.
        temporary.chmod(0o666 & ~_umask())
        return
    new = temporary.stat()
    if (old.st_uid, old.st_gid) != (new.st_uid, new.st_gid):
        with contextlib.suppress(OSError):
            os.chown(temporary, old.st_uid, old.st_gid)
    temporary.chmod(stat.S_IMODE(old.st_mode) & 0o777)


def write_new(path: Path, text: str) -> None:
    """Write a new text file that a user will edit.

    Raises: InputError if it exists: it may be the only copy of somebody's work.
    """
    if path.exists() or path.is_symlink():
        raise InputError(f"expected a file to make, found that {path} is there: give another name")
    write_text(path, text)


def refuse_unwritable(*paths: Path, own: bool = False) -> None:
    """Refuse files that cannot be written, before anything is computed. Raises: InputError.

    Args:
        paths: paths of the files.
        own: whether they are a command's own, so that its user has no other place to name.
    """
    other = "allow writing there, or work on a copy of its folder" if own else "name another"
    for path in paths:
        try:
            place = destination(path, _MOVE if own else _NAME)
            if place.exists() and not os.access(place, os.W_OK):
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
            # What is missing of the path is made later, in the nearest folder there is.
            base = next(parent for parent in place.parents if os.path.lexists(parent))
            with tempfile.TemporaryFile(dir=base):
                pass
        except OSError as error:
            raise InputError(
                f"expected a file that can be written, found {path}: {reason(error)}; {other}"
            ) from None


def _umask() -> int:
    """Return the process's file mode mask, which can only be read by setting it."""
    with _MASK:
        mask = os.umask(0o077)
        os.umask(mask)
    return mask


def _sync_folder(folder: Path) -> None:
    """Write the rename itself to disk."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
