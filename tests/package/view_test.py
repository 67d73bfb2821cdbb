#!/usr/bin/python3
"""`servomill view` of an installation serves its page and the files named; without the page it says how to get it.

view_test.py CMAKE BUILD_FOLDER SOURCE_FOLDER
"""
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import unittest
import urllib.request

SOURCE, BUILD, CMAKE = (os.path.abspath(sys.argv.pop()) for _ in range(3))
PATIENCE = 60  # s, on a machine that others use, too
SHORT = pathlib.Path(SOURCE) / "tests/python/short.toml"
ELSEWHERE = re.compile(rb"""(?:src|href)\s*=\s*["']?(?:https?:)?//|@import|import\s*\(\s*["']http""")


def install(build, prefix, *more):
    subprocess.run([CMAKE, "--install", build, "--prefix", prefix, *more], check=True, capture_output=True)


class InstalledPage(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder, cls.prefix = pathlib.Path(folder.name), pathlib.Path(folder.name) / "prefix"
        install(BUILD, cls.prefix)
        # the program is that of the build under test; only the page comes from a build of its own
        cls.build = cls.folder / "build"
        subprocess.run([CMAKE, "-S", SOURCE, "-B", cls.build, "-G", "Ninja", "-D", "SERVOMILL_PAGE=ON", "-D", "SERVOMILL_TESTS=OFF",
                        "-D", "SERVOMILL_PYTHON=OFF", "-D", f"SERVOMILL_PAGE_FOLDER={SOURCE}/build/page"], check=True, capture_output=True)
        subprocess.run([CMAKE, "--build", cls.build, "--target", "servomill_page"], check=True, capture_output=True)
        install(cls.build, cls.prefix, "--component", "page")
        cls.page = cls.prefix / "share/servomill/page/servomill.html"
        cls.result = cls.folder / "short.h5"
        cls.program = cls.prefix / "bin/servomill"
        subprocess.run([cls.program, "run", SHORT, "-q", "-o", cls.result], check=True)

    def refused(self, *words, program=None, path=None):
        done = subprocess.run([program or self.program, "view", *words], capture_output=True, text=True, check=False, timeout=PATIENCE,
                              env={**os.environ, "PATH": path or os.environ["PATH"]})
        self.assertEqual(done.stdout, "")
        return done.returncode, done.stderr

    def test_serves_the_page_and_the_files(self):
        server = subprocess.Popen([self.program, "view", "short.h5", "--no-browser"], cwd=self.folder, stdout=subprocess.PIPE, text=True)
        self.addCleanup(server.kill)
        address = re.match(r"http://127\.0\.0\.1:\d+/\S+/", server.stdout.readline())[0]
        with urllib.request.urlopen(address, timeout=PATIENCE) as answer:
            self.assertEqual(answer.read(), self.page.read_bytes())
        with urllib.request.urlopen(f"{address}files.json", timeout=PATIENCE) as answer:
            (file,) = json.load(answer)
        with urllib.request.urlopen(address + file["url"], timeout=PATIENCE) as answer:
            self.assertEqual(answer.read(), self.result.read_bytes())
        server.send_signal(signal.SIGINT)
        self.assertEqual(server.wait(timeout=PATIENCE), 0)
        server.stdout.close()

    def test_page_needs_nothing_from_elsewhere(self):
        text = self.page.read_bytes()
        self.assertGreater(len(text), 1_000_000)
        self.assertEqual(ELSEWHERE.findall(text), [])

    def test_refuses_what_cannot_be_shown(self):
        (self.folder / "text.h5").write_text("no HDF5", encoding="ascii")
        wrong = str(self.folder / "text.h5")
        self.assertEqual(self.refused(wrong), (2, f"{wrong}: error: not an HDF5 file\n"))
        self.assertEqual(self.refused("none.h5"), (2, "none.h5: error: cannot be read: No such file or directory\n"))
        self.assertEqual(self.refused(), (2, "servomill view: error: expected result files OUT.h5..., got none; see --help\n"))
        self.assertEqual(self.refused(self.result, "--port", "70000"), (2, "--port: error: 70000; must be >= 0 and <= 65535\n"))
        self.assertEqual(self.refused(self.result, path="/nowhere"),
                         (3, "python3: error: cannot be started: No such file or directory\n"))

    def test_refuses_a_port_that_is_taken(self):
        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.assertEqual(self.refused(self.result, "--no-browser", "--port", str(port)),
                             (2, f"--port: error: {port}: cannot be listened at: Address already in use\n"))

    def test_names_a_page_that_was_left_out(self):
        with tempfile.TemporaryDirectory() as bare:
            program = shutil.copy(self.program, bare)
            self.assertEqual(self.refused(self.result, program=program),
                             (2, "servomill view: error: the page of results was left out of this build (-D SERVOMILL_PAGE=ON adds "
                                 "it); in the source tree tools/view builds and serves it\n"))

    def test_page_is_not_left_out_in_silence(self):
        folder = os.path.dirname(shutil.which("npm"))
        ignored = ";".join((folder, folder.removeprefix("/usr")))  # /bin is /usr/bin
        tools = {"CMAKE_CXX_COMPILER": "c++", "CMAKE_C_COMPILER": "cc", "CMAKE_MAKE_PROGRAM": "ninja"}
        done = subprocess.run([CMAKE, "-S", SOURCE, "-B", self.folder / "without_npm", "-G", "Ninja", "-D", "SERVOMILL_PAGE=ON",
                               "-D", f"CMAKE_IGNORE_PATH={ignored}", *(f"-D{name}={shutil.which(tool)}" for name, tool in tools.items())],
                              capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertRegex(" ".join(done.stderr.split()), "SERVOMILL_PAGE is ON, and (node|npm) is not found: install nodejs and npm")

    def test_no_package_lacks_a_part(self):
        done = subprocess.run([pathlib.Path(CMAKE).with_name("cpack"), "-G", "DEB", "-B", self.folder / "packages"], cwd=self.build,
                              capture_output=True, text=True, check=False)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("the packages contain the page of results and the Python module: SERVOMILL_PYTHON is OFF in this build",
                      " ".join(done.stderr.split()))


if __name__ == "__main__":
    unittest.main()
