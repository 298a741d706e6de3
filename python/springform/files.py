"""Reading text and writing whole files: clear errors, and never half a file."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
import stat
from pathlib import Path

from .errors import InputError

_LARGEST_TEXT = 256 * 2**20  # bytes; beyond it memory, and patience, would end first

_REASONS = {
    errno.ENOENT: "no such file or folder; check the path",
    errno.EACCES: "permission denied; choose another place or change its permissions",
    errno.EPERM: "the operation is not permitted; choose another place",
    errno.EISDIR: "is a folder; give a file",
    errno.ENOTDIR: "a part of the path is not a folder; check the path",
    errno.EROFS: "the disk is read-only; choose another place",
    errno.ENOSPC: "no space left on the disk; free some, or choose another place",
    errno.EDQUOT: "the disk quota is used up; free some space, or choose another place",
    errno.EFBIG: "the file would be larger than allowed here; raise the limit (ulimit -f)",
    errno.ENAMETOOLONG: "the name is too long; choose a shorter one",
    errno.ELOOP: "the links lead in a circle; choose another place",
}


class WriteError(InputError):
    """A file that cannot be written."""


def write_atomically(path: str | os.PathLike[str], data: bytes) -> None:
    """Write `data` to `path`: afterwards the file holds all of it, or is as it was before.

    The data goes to a temporary file in the same folder, is flushed to the disk and then takes
    the name; the temporary file goes away when anything fails. A link is followed; an existing
    file keeps its permissions.

    Raises `WriteError`: the folder is missing or not writable, `path` is a folder or a device,
    the disk is full, the file is too large.
    """
    try:
        _replace(os.path.realpath(path), data)
    except (OSError, ValueError) as error:
        folder = os.path.dirname(os.fspath(path)) or "."
        if isinstance(error, FileNotFoundError):
            message = f"the folder {folder} does not exist; make it first"
        else:
            message = explain(error)
        raise WriteError(f"cannot be written: {message}", file=path) from error


def remove_temporary(folder: str | os.PathLike[str]) -> None:
    """Remove what a process that was killed while it wrote left in a folder."""
    for path in Path(folder).glob(".springform-*.tmp"):
        with contextlib.suppress(OSError):
            path.unlink()


def read_text(path: str | os.PathLike[str], kind: type[InputError] = InputError) -> str:
    """Return the text of a UTF-8 file (a byte order mark is dropped, line ends are kept).

    Raises `kind` (an `InputError` or a class below it): the file is missing, a folder, not
    readable, larger than 256 MiB, or not UTF-8 (then with the line).
    """
    try:
        with open(path, "rb") as file:
            data = file.read(_LARGEST_TEXT + 1)
    except (OSError, ValueError) as error:
        raise kind(f"cannot be read: {explain(error)}", file=path) from error
    if len(data) > _LARGEST_TEXT:
        limit = _LARGEST_TEXT // 2**20
        raise kind(f"cannot be read: it is larger than {limit} MiB; check the file", file=path)
    return decoded(data, path, kind)


def decoded(data: bytes, path: str | os.PathLike[str], kind: type[InputError] = InputError) -> str:
    """Return what a file holds as text (a byte order mark is dropped, line ends are kept).

    Raises `kind` with the line: it is not UTF-8. `path` is what the error names.
    """
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise kind(
            f"byte {data[error.start]:#04x} is not UTF-8 text; save the file as UTF-8",
            file=path,
            line=data.count(b"\n", 0, error.start) + 1,
        ) from error


def explain(error: OSError | ValueError) -> str:
    """Return what went wrong with a file, and what to do, in one plain clause."""
    if isinstance(error, OSError):
        return _REASONS.get(error.errno or 0) or (error.strerror or str(error)).lower()
    return "the path holds a character that file names cannot have; choose another name"


def _replace(target: str, data: bytes) -> None:
    mode = None
    with contextlib.suppress(FileNotFoundError):
        mode = os.stat(target).st_mode
    if mode is not None and stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), target)
    if mode is not None and not stat.S_ISREG(mode):
        # Renaming over a device or a pipe would destroy it.
        raise OSError(errno.EINVAL, "it is not an ordinary file; choose another name")

    folder = os.path.dirname(target)
    temporary = os.path.join(folder, f".springform-{os.getpid()}-{secrets.token_hex(4)}.tmp")
    descriptor = os.open(temporary, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        with os.fdopen(descriptor, "wb") as file:
            if mode is not None:
                os.chmod(temporary, stat.S_IMODE(mode))
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        os.replace(temporary, target)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(temporary)
        raise
    _flush_folder(folder)


def _flush_folder(folder: str) -> None:
    # The data is safe by now; only the new name may still be lost in a power cut, and not every
    # system can flush a folder.
    with contextlib.suppress(OSError):
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(descriptor)
        finally:
            os.close(descriptor)
