# SPDX-License-Identifier: GPL-3.0-or-later
"""A private X server for tests, the environment of programs that use it, and a program driven by X events."""
import ctypes
import os
import signal
import subprocess
import threading
import time


def end_with_parent():
    """Called in a new process: even a test that is killed for taking too long leaves no X server behind."""
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGTERM)


def start_x_server(add_cleanup, size):
    """add_cleanup: of a test case or class. @return the display, such as ":7" """
    readable, writable = os.pipe()
    # The server chooses a free display itself: tests can run side by side.
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writable), "-screen", "0", size + "x24", "+extension", "GLX", "-nolisten", "tcp"],
        pass_fds=[writable], preexec_fn=end_with_parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    add_cleanup(server.wait)
    add_cleanup(server.terminate)
    os.close(writable)
    with os.fdopen(readable) as pipe:
        display = pipe.readline().strip()
    assert display, "Xvfb did not start"
    return ":" + display


def host_environment(display, home):
    """For a staged MeshLab with a home of its own."""
    environment = dict(os.environ, DISPLAY=display, HOME=str(home), XDG_RUNTIME_DIR=str(home),
                       XDG_CONFIG_HOME=str(home), LIBGL_ALWAYS_SOFTWARE="1")
    if os.environ.get("LAPEDIT_PRELOAD"):
        environment["LD_PRELOAD"] = os.environ["LAPEDIT_PRELOAD"]
    return environment


class XProgram:
    """A running program with a window. A subclass has fail(sentence), which raises an error."""
    patience = 60  # seconds

    def __init__(self, command, environment, **options):
        self.environment = environment
        self.output = []  # lines
        self.process = subprocess.Popen(list(map(str, command)), env=environment, stdin=subprocess.DEVNULL,
                                        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)
        self.reader = threading.Thread(target=self._read_output, daemon=True)
        self.reader.start()

    def _read_output(self):
        for line in self.process.stdout:
            self.output.append(line.decode(errors="replace").rstrip("\n"))

    def text(self):
        return "\n".join(self.output)

    def wait(self, condition, sentence, patience=None):
        """@return what the condition returns, once that is true; when the program has ended, it gets a last chance"""
        end, has_ended = time.monotonic() + (patience or self.patience), False
        while not (found := condition()):
            if has_ended or time.monotonic() > end:
                self.fail(sentence)
            has_ended = self.process.poll() is not None
            time.sleep(0.02)
        return found

    def x(self, *arguments, attempts=1, check=True):
        """xdotool with these arguments. @return what it prints"""
        for attempt in range(attempts):
            time.sleep(0.3 * attempt)
            done = subprocess.run(["xdotool", *map(str, arguments)], env=self.environment, stdout=subprocess.PIPE,
                                  stderr=subprocess.STDOUT, timeout=self.patience, check=False)
            if done.returncode == 0 or not check:
                return done.stdout.decode()
        return self.fail(f"xdotool {arguments}: {done.stdout.decode()}")

    def x_drag(self, start, end, steps=8):
        """Screen pixels; from press to release."""
        self.x("mousemove", *start, "sleep", 0.1, "mousedown", 1)
        for i in range(1, steps + 1):
            self.x("mousemove", *(round(a + (b - a) * i / steps) for a, b in zip(start, end)), "sleep", 0.05)
        self.x("sleep", 0.1, "mouseup", 1)
