"""Serves the page of results and result files to the browser of this computer, until Ctrl-C.

    serve.py servomill.html OUT.h5... [--no-browser] [--port N]

The page and these files alone are served, to this computer alone (127.0.0.1), under an address that cannot be guessed. Run by
`servomill view` and, in the source tree, by tools/view. Exit status: 0 ended, 2 a file cannot be read, 3 the system failed.
"""
import argparse
import hmac
import http.server
import json
import os
import pathlib
import re
import secrets
import signal
import sys
import urllib.parse
import webbrowser

SIGNATURE = b"\x89HDF\r\n\x1a\n"
PIECE = 1 << 20  # bytes sent at a time
RANGE = re.compile(r"bytes=(\d+)-(\d*)")


class InputError(Exception):
    """A file that cannot be shown; the text is one complete line."""


class ResultFile:
    """A file as it was when the command began; one that was replaced is not mixed with it."""

    def __init__(self, name):
        self.path = pathlib.Path(name)
        try:
            with open(name, "rb") as stream:
                if stream.read(len(SIGNATURE)) != SIGNATURE:
                    raise InputError(f"{name}: error: not an HDF5 file")
                self.state = self.state_of(stream)
        except OSError as fault:
            raise InputError(f"{name}: error: cannot be read: {fault.strerror}") from None

    @staticmethod
    def state_of(stream):
        status = os.fstat(stream.fileno())
        return status.st_size, status.st_mtime_ns, status.st_ino

    def refresh(self):
        with open(self.path, "rb") as stream:
            self.state = self.state_of(stream)

    @property
    def size(self):
        return self.state[0]

    @property
    def version(self):
        return "-".join(f"{part:x}" for part in self.state)


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server_version = "servomill"
    sys_version = ""

    def do_GET(self):  # noqa: N802, a name of the library
        self.answer(with_body=True)

    def do_HEAD(self):  # noqa: N802
        self.answer(with_body=False)

    def answer(self, with_body):
        host = self.headers.get("Host", "")
        parts = urllib.parse.urlsplit(self.path).path.split("/")[1:]
        # The name of the host: a page of elsewhere whose name leads to 127.0.0.1 learns nothing.
        if host not in self.server.hosts or not parts or not hmac.compare_digest(parts[0].encode(), self.server.token.encode()):
            return self.refuse(404)
        rest = parts[1:]
        if rest == [""]:
            return self.send_text(self.server.page, "text/html; charset=utf-8", with_body)
        if rest == ["files.json"]:
            return self.send_text(self.listing(), "application/json", with_body)
        if len(rest) == 3 and rest[0] == "file" and rest[1].isdecimal() and int(rest[1]) < len(self.server.files):
            return self.send_file(self.server.files[int(rest[1])], rest[2], with_body)
        return self.refuse(404)

    def listing(self):
        """What the page opens; a file that was replaced since is served as it is now."""
        out = []
        for number, file in enumerate(self.server.files):
            try:
                file.refresh()
            except OSError:
                continue
            out.append({"name": file.path.name, "size": file.size, "url": f"file/{number}/{file.version}"})
        return json.dumps(out).encode()

    def send_text(self, body, kind, with_body):
        self.begin(200, kind, len(body))
        if with_body:
            self.wfile.write(body)

    def send_file(self, file, version, with_body):
        try:
            stream = open(file.path, "rb")
        except OSError:
            return self.refuse(410)
        with stream:
            if file.version != version or file.state_of(stream) != file.state:
                return self.refuse(410)
            wanted = RANGE.fullmatch(self.headers.get("Range", ""))
            first, last = 0, file.size - 1
            if wanted:
                first, last = int(wanted[1]), min(last, int(wanted[2] or last))
                if first > last:
                    return self.refuse(416, [("Content-Range", f"bytes */{file.size}")])
            more = [("Content-Range", f"bytes {first}-{last}/{file.size}")] if wanted else []
            self.begin(206 if wanted else 200, "application/x-hdf5", last - first + 1, more)
            if with_body:
                self.send_bytes(stream, first, last + 1)
        return None

    def send_bytes(self, stream, first, end):
        stream.seek(first)
        while first < end:
            piece = stream.read(min(PIECE, end - first))
            if not piece:
                self.close_connection = True  # shorter than announced: it was cut meanwhile
                return
            self.wfile.write(piece)
            first += len(piece)

    def begin(self, status, kind, length, more=()):
        self.send_response(status)
        headers = [("Content-Type", kind), ("Content-Length", str(length)), ("Accept-Ranges", "bytes"), ("Cache-Control", "no-store"),
                   ("Cross-Origin-Resource-Policy", "same-origin"), ("X-Content-Type-Options", "nosniff"), ("Referrer-Policy", "no-referrer")]
        for name, value in [*headers, *more]:
            self.send_header(name, value)
        self.end_headers()

    def refuse(self, status, more=()):
        self.begin(status, "text/plain", 0, more)

    def log_message(self, *_):
        pass


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, files, page, port):
        super().__init__(("127.0.0.1", port), Handler)
        self.files, self.page, self.token = files, page, secrets.token_urlsafe(24)
        self.hosts = {f"127.0.0.1:{self.server_port}", f"localhost:{self.server_port}"}

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server_port}/{self.token}/"

    def handle_error(self, *_):
        pass  # the browser closed a connection that it did not need any more


def started(files, page, port):
    try:
        return Server(files, page, port)
    except OSError as fault:
        raise InputError(f"--port: error: {port}: cannot be listened at: {fault.strerror}") from None


def main(arguments):
    parser = argparse.ArgumentParser(prog="serve.py", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", type=pathlib.Path, help="servomill.html")
    parser.add_argument("files", nargs="+", metavar="OUT.h5", help="result files of servomill")
    parser.add_argument("--no-browser", action="store_true", help="prints the address instead of opening the browser")
    parser.add_argument("--port", type=int, default=0, help="of the address (default: one that is free)")
    chosen = parser.parse_args(arguments)
    files = [ResultFile(name) for name in chosen.files]
    with started(files, chosen.page.read_bytes(), chosen.port) as server:
        print(f"{server.address}   (Ctrl-C ends it)", flush=True)
        if not chosen.no_browser and not webbrowser.open(server.address):
            print("view: no browser was found; open the address above", file=sys.stderr)
        server.serve_forever()


def end(*_):
    raise KeyboardInterrupt


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, end)
    try:
        main(sys.argv[1:])
    except KeyboardInterrupt:
        print()
    except InputError as fault:
        print(fault, file=sys.stderr)
        sys.exit(2)
    except OSError as fault:
        print(f"view: error: {fault}", file=sys.stderr)
        sys.exit(3)
