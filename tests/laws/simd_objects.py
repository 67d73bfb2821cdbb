#!/usr/bin/python3
"""Kernels, compiled for newer processors, leave no functions behind that other sources could share.

The linker keeps one copy of an inline function and gives it to all who use it. A copy from a kernel
would stop the program on a machine without AVX. So each function that a kernel object offers must
carry its architecture in its name.
"""
import pathlib
import subprocess
import sys


def strangers(path):
    listing = subprocess.run(["nm", "--defined-only", "-C", str(path)], capture_output=True,
                             text=True, check=True).stdout
    for line in listing.splitlines():
        _, kind, name = line.split(" ", 2)
        own = "xsimd::" in name or "SimdLevel)" in name
        if kind in "WuT" and not own:
            yield name


def main(build):
    objects = [p for level in ("avx2", "avx512")
               for p in pathlib.Path(build).glob(f"**/*_{level}.dir/**/*.o")]
    found = [f"{p.name}: {name}" for p in objects for name in strangers(p)]
    print(f"{len(objects)} kernel objects")
    print("\n".join(found))
    return 1 if found or not objects else 0  # without objects it was looked for in the wrong place


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
