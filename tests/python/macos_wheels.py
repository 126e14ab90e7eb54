# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the files in wheels for macOS, which cannot be run here: processor, oldest macOS, libraries, where symbols come from,
and for arm64 the signature, without which macOS ends the process there.

usage: macos_wheels.py WHEEL...     It needs llvm-objdump.
"""
import hashlib
import pathlib
import re
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

WHEELS = sys.argv[1:]


def headers(path):
    return subprocess.run(["llvm-objdump", "--macho", "--private-headers", path], check=True, capture_output=True, text=True).stdout


def bindings(path):
    """@return library and name of each symbol that is taken from elsewhere"""
    found = set()
    for kind in ("--bind", "--lazy-bind"):
        text = subprocess.run(["llvm-objdump", "--macho", kind, path], check=True, capture_output=True, text=True).stdout
        found.update(re.findall(r"0x[0-9A-F]+ .*?(flat-namespace|libSystem|\S+) +(_\S+)", text))
    return found


def page_hashes(data, offset):
    """@return the hashes of pages in the signature at this offset, and those of the file"""
    magic, _, count = struct.unpack_from(">3I", data, offset)
    assert magic == 0xFADE0CC0
    blobs = [struct.unpack_from(">2I", data, offset + 12 + 8 * k)[1] for k in range(count)]
    at = next(offset + blob for blob in blobs if struct.unpack_from(">I", data, offset + blob)[0] == 0xFADE0C02)
    hashes, _, _, pages, limit, size, kind, _, shift = struct.unpack_from(">5I4B", data, at + 16)
    assert (size, kind) == (32, 2)  # SHA-256
    signed = [data[at + hashes + 32 * k:at + hashes + 32 * (k + 1)] for k in range(pages)]
    return signed, [hashlib.sha256(data[k:min(k + (1 << shift), limit)]).digest() for k in range(0, limit, 1 << shift)]


class Files(unittest.TestCase):
    def test_each(self):
        self.assertEqual(len(WHEELS), 2)
        for wheel in map(pathlib.Path, WHEELS):
            with self.subTest(wheel=wheel.name), tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(wheel) as files:
                names = [name for name in files.namelist() if name.endswith(("/scripts/laplacian-edit", ".so"))]
                self.assertEqual(len(names), 2)
                for name in names:
                    path = files.extract(name, folder)
                    data, text, bound = pathlib.Path(path).read_bytes(), headers(path), bindings(path)
                    self.assertRegex(text, "ARM64" if "arm64" in wheel.name else "X86_64")
                    self.assertRegex(text, r"platform macos\s+sdk \S+\s+minos 11\.0\n")
                    self.assertEqual(re.findall(r"cmd LC_LOAD_DYLIB\s.*\s+name (\S+)", text), ["/usr/lib/libSystem.B.dylib"])
                    self.assertGreater(len(bound), 100)
                    # Python's are found when the module is loaded; a misspelt or missing one of the system's would be there too.
                    python = {symbol for _, symbol in bound if re.match("__?Py", symbol)}
                    self.assertEqual({symbol for library, symbol in bound if library == "flat-namespace"}, python)
                    self.assertEqual({library for library, _ in bound} - {"flat-namespace"}, {"libSystem"})
                    self.assertEqual(bool(python), name.endswith(".so"))
                    if name.endswith(".so"):
                        self.assertIn(b"\0_PyInit__core\0", data)
                    if "arm64" in wheel.name:
                        signed, real = page_hashes(data, int(re.search(r"LC_CODE_SIGNATURE\s+cmdsize 16\s+dataoff (\d+)", text)[1]))
                        self.assertGreater(len(real), 100)
                        self.assertEqual(signed, real)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
