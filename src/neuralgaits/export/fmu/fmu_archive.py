"""Make the file of an FMU: description, C sources, and a binary for this machine."""

import io
import platform
import sys
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path

from neuralgaits.export import build, output_folder
from neuralgaits.export.design import Design
from neuralgaits.export.fmu.fmu_sources import (
    compiled_files,
    headers,
    model_identifier,
    source_files,
)
from neuralgaits.export.fmu.fmu_variables import variables_of
from neuralgaits.export.fmu.model_description import build_description, model_description


def fmu_file(
    design: Design, version: str, controller: Mapping[str, str], compilers: Sequence[str]
) -> tuple[str, bytes]:
    """Return the name and the content of an FMU.

    Args:
        design: design of the controller.
        version: `2.0` or `3.0`.
        controller: files of the exported controller, those of its monitor included.
        compilers: compilers that the sources have to suit; the first one makes the binary. Without
            any, the FMU has sources alone.

    Raises: MismatchError with the first complaint of a compiler.
    """
    model, variables = model_identifier(design), variables_of(design)
    sources, token = source_files(design, variables, version, controller)
    compiled = compiled_files(design, version)
    described = model_description(design, variables, version, model, token, compiled)
    files: dict[str, str | bytes] = {"modelDescription.xml": described}
    files |= {f"sources/{name}": text for name, text in sources.items()}
    if version == "3.0":
        files["sources/buildDescription.xml"] = build_description(model, compiled)
    folder, suffix = binary_place(version)
    for number, compiler in enumerate(compilers):
        binary = _compiled(compiler, model + suffix, sources, compiled)
        if number == 0:
            files[f"binaries/{folder}/{model}{suffix}"] = binary
    return f"{model}.fmu", archive(files)


def binary_place(version: str) -> tuple[str, str]:
    """Return the folder of this machine's binaries, and their suffix."""
    # Names of systems in FMI 3.0 and 2.0, and the suffix of their libraries.
    systems = {
        "linux": ("linux", "linux", ".so"),
        "darwin": ("darwin", "darwin", ".dylib"),
        "win32": ("windows", "win", ".dll"),
    }
    three, two, suffix = systems.get(sys.platform, systems["linux"])
    machine = platform.machine().lower().replace("amd64", "x86_64").replace("arm64", "aarch64")
    bits = "64" if sys.maxsize > 2**32 else "32"
    folder = f"{machine}-{three}" if version == "3.0" else f"{two}{bits}"
    return folder, suffix


def archive(files: Mapping[str, str | bytes]) -> bytes:
    """Return a zip file with these files, the same bytes for the same content."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as zipped:
        # Date of every entry, so that the same gait gives the same file.
        epoch = (1980, 1, 1, 0, 0, 0)
        for name, content in files.items():
            entry = zipfile.ZipInfo(name, epoch)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, on every machine: the permissions are Unix's.
            entry.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
            zipped.writestr(entry, content)
    return out.getvalue()


def _compiled(
    compiler: str, name: str, sources: Mapping[str, str], compiled: Sequence[str]
) -> bytes:
    """Return the binary. Raises: MismatchError if it does not compile without a warning."""
    # Of its functions only those of the standard are seen.
    flags = (*build.PLAIN, "-fPIC", "-shared", "-fvisibility=hidden")
    stripped = ("-s",) if sys.platform == "linux" else ()
    with output_folder.scratch({**sources, **headers()}) as folder:
        binary: Path = build.build(compiler, folder, name, tuple(compiled), (*flags, *stripped))
        return binary.read_bytes()
