"""LinuxCNC without display and hardware: starts it, runs programs, records its setpoints."""
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

HERE = pathlib.Path(__file__).parent
PORT = 5007  # of linuxcncrsh
NEEDED = ("linuxcnc", "halsampler", "linuxcncrsh")
START = 30.0  # s, in which LinuxCNC answers
REST = 0.5    # s, of rest before and after a program


class ControlError(Exception):
    """LinuxCNC is not there, or does not do what it is asked."""


def as_user(words, folder, user):
    """The command as a user who is not root, as whom LinuxCNC refuses to run."""
    if os.geteuid() != 0:
        return list(words)
    return ["runuser", "-u", user, "--", "env", f"HOME={folder}", *words]


class Control:
    """With `with`: LinuxCNC of an INI file, ready to run programs."""

    def __init__(self, folder, user="nobody"):
        missing = [name for name in NEEDED if shutil.which(name) is None]
        if missing:
            raise ControlError(f"{', '.join(missing)}: not found; they are in Debian's linuxcnc-uspace")
        self.folder, self.user = pathlib.Path(folder), user
        for name in ("mill.ini", "mill.hal"):
            shutil.copy(HERE / name, self.folder)
        (self.folder / "mill.tbl").write_text("T1 P1 D6\n", encoding="utf-8")
        (self.folder / "mill.var").touch()
        if os.geteuid() == 0:
            for file in (self.folder, *self.folder.iterdir()):
                shutil.chown(file, user)
        self.process, self.socket = None, None

    def __enter__(self):
        words = as_user(["linuxcnc", str(self.folder / "mill.ini")], self.folder, self.user)
        self.process = subprocess.Popen(words, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                                        start_new_session=True)
        try:
            self.connect()
            for order in ("enable EMCTOO", "echo off", "verbose off", "set_wait received", "estop off", "machine on"):
                self.send(f"set {order}")
                time.sleep(0.2)
            for joint in range(3):
                self.send(f"set home {joint}")
                time.sleep(0.2)
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.socket is not None:
            self.socket.close()
        os.killpg(self.process.pid, signal.SIGTERM)
        try:
            self.process.wait(20)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
        return False

    def connect(self):
        end = time.monotonic() + START
        while True:
            try:
                self.socket = socket.create_connection(("localhost", PORT), 2.0)
                break
            except OSError as error:
                if time.monotonic() > end or self.process.poll() is not None:
                    raise ControlError(f"LinuxCNC does not answer: {error}; see {self.folder}/linuxcnc_print.txt") from error
                time.sleep(0.5)
        self.send("hello EMC servomill 1.0")
        time.sleep(0.2)

    def send(self, line):
        self.socket.sendall((line + "\r\n").encode())

    def ask(self, what):
        """Answer to `get`, without what came before."""
        self.socket.settimeout(0.1)
        try:
            while self.socket.recv(4096):
                pass
        except TimeoutError:
            pass
        self.socket.settimeout(2.0)
        self.send(f"get {what}")
        return self.socket.recv(4096).decode().strip()

    def run(self, program, log, patience):
        """Runs a program from X0 Y0 Z0 and records its setpoints, one row a servo period."""
        self.send("set mode mdi")
        time.sleep(0.2)
        self.send("set mdi G90 G21 G0 X0 Y0 Z0")
        time.sleep(0.3)
        self.wait(patience)
        self.record(os.devnull, lambda: time.sleep(REST))  # what the sampler still holds of earlier motion

        def run():
            time.sleep(REST)
            self.send("set mode auto")
            time.sleep(0.2)
            self.send(f"set open {program}")
            time.sleep(0.2)
            self.send("set run")
            time.sleep(0.3)
            self.wait(patience)
            time.sleep(REST)
        self.record(log, run)

    def record(self, log, meanwhile):
        words = as_user(["halsampler", "-t"], self.folder, self.user)
        with open(log, "wb") as out:
            sampler = subprocess.Popen(words, stdout=out, stderr=subprocess.DEVNULL, start_new_session=True)
            try:
                meanwhile()
            finally:
                os.killpg(sampler.pid, signal.SIGINT)
                sampler.wait(5)

    def wait(self, patience):
        end = time.monotonic() + patience
        while "IDLE" not in self.ask("program_status").upper():
            if time.monotonic() > end:
                raise ControlError(f"a program does not end within {patience:g} s")
            time.sleep(0.1)
