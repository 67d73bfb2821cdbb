"""Tests that run the program in a temporary folder with files of their own."""
import os
import shutil
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


class InScenarios(unittest.TestCase):
    """Tests that share a copy of some folders of scenarios, and run the program in one of them."""
    program = ""  # path of servomill
    scenarios = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scenarios")
    copied, works_in = (), ()  # names of folders; path of the working folder in the copy

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        for name in cls.copied:
            shutil.copytree(os.path.join(cls.scenarios, name), os.path.join(cls.folder, name))
        cls.cwd = os.path.join(cls.folder, *cls.works_in)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.folder)

    @classmethod
    def run_in_folder(cls, *arguments, status=0):
        done = subprocess.run([cls.program, *arguments], cwd=cls.cwd, capture_output=True, text=True, check=False)
        assert done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}"
        return done
