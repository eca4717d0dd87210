"""Small C programs around a source, for tests."""

import subprocess
from pathlib import Path

import numpy as np

from neuralgaits.export import build, output_folder

DOUBLE, FLOAT = (), ("-DNG_FLOAT",)


def folder_with(path: Path, files: dict[str, str]) -> Path:
    """A folder that holds the shipped files, the harness and these."""
    path.mkdir(parents=True, exist_ok=True)
    for name, text in (output_folder.shipped() | output_folder.harness() | files).items():
        (path / name).write_text(text)
    return path


def filter_program(path: Path, source: str, flags: tuple[str, ...]) -> Path:
    """Compile `source`, a C file that reads doubles and writes doubles."""
    folder = folder_with(path, {"filter.c": source})
    return build.build("gcc", folder, "filter", ("filter.c",), ("-O2", *flags))


def through(program: Path, numbers: np.ndarray) -> np.ndarray:
    """What a filter makes of some numbers."""
    data = np.ascontiguousarray(numbers, dtype=np.float64).tobytes()
    done = subprocess.run([str(program)], input=data, capture_output=True, check=True)
    return np.frombuffer(done.stdout)


def filter_source(before: str, call: str, inputs: int, outputs: int) -> str:
    """A C file that calls `call` with `in` and `out` once for each record of `inputs` doubles."""
    return f"""
#include <stdio.h>
#include "ng_math.h"
{before}
int main(void)
{{
    double raw[{inputs}];
    while (fread(raw, sizeof raw, 1, stdin) == 1) {{
        ng_real in[{inputs}], out[{outputs}];
        double wide[{outputs}];
        for (int i = 0; i < {inputs}; ++i) {{
            in[i] = (ng_real)raw[i];
        }}
        {call}
        for (int i = 0; i < {outputs}; ++i) {{
            wide[i] = (double)out[i];
        }}
        if (fwrite(wide, sizeof wide, 1, stdout) != 1) {{
            return 1;
        }}
    }}
    return 0;
}}
"""
