"""Tests that run the program in a temporary folder with files of their own."""
import os
import subprocess
import tempfile
import unittest

PATIENCE = 120  # s, far more than any of these commands takes


class InFolder(unittest.TestCase):
    program = ""  # path of servomill

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = temporary.name

    def write(self, name, text):
        with open(os.path.join(self.folder, name), "w", encoding="utf-8") as file:
            file.write(text)

    def servomill(self, *arguments, status=0):
        done = subprocess.run([self.program, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=PATIENCE,
                              check=False)
        self.assertEqual(done.returncode, status, f"{arguments}\n{done.stdout}{done.stderr}")
        return done
