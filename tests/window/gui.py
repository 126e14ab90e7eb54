# SPDX-License-Identifier: GPL-3.0-or-later
"""Starts the staged MeshLab on a private X server and drives its window, for tests.

The window is driven from inside, by the plugin in tests/window/driver, or from outside, by xdotool.
Environment: as tests/cli/host.py has it; the stage holds the driver as well.
"""
import collections
import json
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "cli"))

from host import STAGE, FilterHost  # noqa: E402
from x_server import XProgram, end_with_parent  # noqa: E402

# Where hosts differ. Only MeshLab 2020.09 has a meshlabserver, which shows nothing of why a filter failed: the plugin logs
# that itself then, besides the host.
LINES_OF_REFUSAL = 2 if (STAGE / "bin" / "meshlabserver").exists() else 1

PATIENCE = 120  # seconds; a machine may be busy, and sanitizers are slow


class Dump:
    """All that the driver tells of a layer. Arrays by name as bytes, so that == compares bits."""

    def __init__(self, reply, data):
        self.box = reply["box"]
        self.arrays = {name: data[begin:begin + length] for name, (begin, length) in reply["arrays"].items()}

    def __getitem__(self, name):
        return self.arrays[name]

    def differences(self, other):
        """Names of what is not equal to the bit."""
        names = [name for name in self.arrays if self.arrays[name] != other.arrays.get(name)]
        return names + (["box"] if self.box != other.box else [])

    def triples(self, name="positions"):
        return list(struct.iter_unpack("<3f", self.arrays[name]))

    def point_bits(self):
        return list(struct.iter_unpack("<3I", self.arrays["positions"]))

    def faces(self):
        return list(struct.iter_unpack("<3i", self.arrays["faces"]))

    def moved(self, other):
        """Vertices whose positions differ in any bit."""
        return {v for v, (a, b) in enumerate(zip(self.point_bits(), other.point_bits())) if a != b}


class Window(XProgram):
    """A running MeshLab. As a context manager it is closed at the end, and must end well."""
    patience = PATIENCE

    def __init__(self, environment, folder, files=()):
        self.folder = pathlib.Path(folder)
        self.marks = 0
        self.recent = collections.deque(maxlen=25)
        path = self.folder / "driver"
        path.unlink(missing_ok=True)
        super().__init__([STAGE / "bin" / "meshlab", *files], dict(environment, LAPEDIT_GUI_SOCKET=str(path)), cwd=folder,
                         preexec_fn=end_with_parent)
        try:
            self.socket = socket.socket(socket.AF_UNIX)
            self.socket.settimeout(PATIENCE + 30)
            self.wait(lambda: self._connect(path), "MeshLab did not start")
            self.answers = self.socket.makefile("rb")
            self.wait(lambda: self._opened(files), "MeshLab did not open all files")
            self.idle()
        except BaseException:
            self.kill()
            raise

    def _connect(self, path):
        """The file is there a moment before the driver listens."""
        try:
            self.socket.connect(str(path))
        except (FileNotFoundError, ConnectionRefusedError):
            return False
        return True

    def _opened(self, files):
        if found := self.dialog():
            self.fail(f"MeshLab begins with the dialog {found}")
        return not files or self._printed("All files opened")

    def _printed(self, text):
        return any(text in line for line in self.output)

    def fail(self, sentence):
        try:
            code = self.process.wait(2)
            self.reader.join(5)
            sentence += f"; MeshLab ended with {code}"
        except subprocess.TimeoutExpired:
            try:  # MeshLab may be waiting for an answer that nobody gives
                self.socket.settimeout(2)
                self.socket.sendall(b'{"command": "dialog"}\n')
                sentence += f"; open is the dialog {self.answers.readline().strip()}"
            except OSError:
                pass
        recent = "\n".join(self.recent)
        raise AssertionError(f"{sentence}\nWhat was asked last:\n{recent}\nOutput of MeshLab:\n{self.text()}")

    def kill(self):
        self.process.kill()
        self.process.wait()
        self.reader.join(5)

    def __enter__(self):
        return self

    def __exit__(self, kind, error, _trace):
        try:
            if kind is not None:
                self.kill()
                if "Output of MeshLab" not in str(error):
                    print("Output of MeshLab:\n" + self.text(), file=sys.stderr)
            elif self.process.poll() is None:
                self.quit()
        finally:
            self.answers.close()
            self.socket.close()
            self.process.stdout.close()

    def ask(self, command, **arguments):
        line = json.dumps({"command": command, **{k: v for k, v in arguments.items() if v is not None}})
        self.recent.append(line[:200])
        try:
            self.socket.sendall(line.encode() + b"\n")
            reply = self.answers.readline()
        except OSError as error:
            self.fail(f"{line[:200]}: {error}")
        if not reply:
            self.fail(f"MeshLab went away at {line[:200]}")
        reply = json.loads(reply)
        if "error" in reply:
            self.fail(f"{line[:200]}: {reply['error']}")
        if command == "dialog":
            self.recent.append(f"-> {reply}")
        return reply

    def batch(self, requests):
        """Requests that ask() could make, none of which opens a dialog, one right after the other.
        @return  number and reason of those that could not be done"""
        self.recent.append(f"a batch of {len(requests)}")
        self.recent.extend(json.dumps(request) for request in requests[-20:])
        return self.ask("batch", requests=requests)["errors"]

    def idle(self):
        """Until the tool has nothing to do and all is painted."""
        self.ask("idle", seconds=PATIENCE)

    def seen(self):
        """Until the drag is painted as the mouse has it; idle() also waits for the tool to solve in full."""
        self.ask("idle", seconds=PATIENCE, frame=True)

    def do(self, command, wait=True, **arguments):
        """A request and what follows from it. wait: False if it opens a dialog"""
        self.ask(command, **arguments)
        if wait:
            self.idle()

    def mouse(self, kind, x, y, button="left", modifiers=(), wait=False):
        """kind: press, move, release or double; pixels of the view, from its upper left corner"""
        self.do("mouse", wait, type=kind, x=x, y=y, button=button, modifiers=list(modifiers))

    def click(self, x, y, button="left", modifiers=()):
        """Waits until the click has been painted, and so handled."""
        self.mouse("press", x, y, button, modifiers, wait=True)
        self.release(x, y, button, modifiers)

    def release(self, x, y, button="left", modifiers=()):
        self.mouse("release", x, y, button, modifiers, wait=True)

    def drag(self, start, end, button="left", modifiers=(), steps=5, release=True):
        self.mouse("press", *start, button, modifiers, wait=True)
        for i in range(1, steps + 1):
            self.mouse("move", *(a + (b - a) * i / steps for a, b in zip(start, end)), button, modifiers)
            self.seen()
        if release:
            self.mouse("release", *end, button, modifiers)
        self.idle()

    def move(self, x, y, modifiers=()):
        """Without a button, except those that are held."""
        self.mouse("move", x, y, modifiers=modifiers, wait=True)

    def wheel(self, x, y, notches, modifiers=()):
        self.do("wheel", x=x, y=y, delta=120 * notches, modifiers=list(modifiers))

    def key(self, *keys, modifiers=()):
        """Characters, or names such as Return, Backspace and Esc; each pressed and released."""
        for key in keys:
            self.ask("key", key=key, modifiers=list(modifiers))
        self.idle()

    def action(self, text):
        """What is known of an action of the menus, {} if there is none."""
        return self.ask("action", text=text)

    def trigger(self, text, wait=True):
        self.do("trigger", wait, text=text)

    def widget(self, name):
        return self.ask("widget", name=name)

    def widgets(self, prefix="", inside=None):
        """By their names: those that begin with a prefix, or those inside a widget."""
        return {w["name"]: w for w in self.ask("widgets", prefix=prefix, inside=inside)["widgets"]}

    def set(self, name, value):
        self.do("set", name=name, value=value)

    def press_button(self, name=None, text=None, wait=True):
        self.do("click", wait, name=name, text=text)

    def close_widget(self, name):
        self.do("close", name=name)

    def dialog(self):
        """The modal dialog that is open, {} if none is; "files" are those chosen in a dialog for files."""
        return self.ask("dialog")

    def wait_dialog(self, has_keys=False):
        """Until a modal dialog is open, and has the keyboard if that counts. @return it"""
        return self.wait(lambda: (found := self.dialog()).get("active", False) >= has_keys and found, "no dialog opened", 20)

    def answer(self, path=None, button=None, wait=True):
        """Answers the dialog that is about to open. @return what it was"""
        found = self.wait_dialog()
        self.ask("answer", path=None if path is None else str(path), button=button)
        if wait:
            self.idle()
            # A busy machine takes its time to close it, and the next answer is for another one.
            self.wait(lambda: self.dialog().get("number") != found["number"], "the dialog stays open", 20)
        return found

    def run_filter(self, name):
        """With its default parameters, as from the menu."""
        self.trigger(name)
        if any(w["visible"] and w.get("text") in ("Apply", "&Apply") for w in self.ask("widgets")["widgets"]):
            self.press_button(text="Apply")
            self.press_button(text="Close")

    def layers(self):
        return self.ask("layers")["layers"]

    def layer(self, layer=None, **changes):
        """Changes of a layer: current, visible, smooth, matrix, selected_faces, selected_vertices, remove."""
        self.do("layer", layer=layer, **changes)

    def dump(self, layer=None):
        path = self.folder / "dump"
        return Dump(self.ask("dump", layer=layer, path=str(path)), path.read_bytes())

    def pixel(self, vertex, layer=None):
        return self.project(vertices=[vertex], layer=layer)[0]

    def project(self, vertices=(), points=(), layer=None):
        """Pixels of vertices, then of points in the layer's coordinates."""
        flat = [c for p in points for c in p]
        return [tuple(p) for p in self.ask("project", layer=layer, vertices=list(vertices), points=flat)["pixels"]]

    def camera(self):
        return self.ask("camera")

    def wait_tool(self, title, suspended):
        self.wait(lambda: self.tool() == (title, suspended), f"the tool does not become {title}, {suspended}", 20)

    def wait_message(self, pattern):
        """Until a line over the picture is like that."""
        self.wait(lambda: any(re.search(pattern, text) for text in self.on_screen()), f"no message {pattern}", 20)

    def wait_cursor(self, shape):
        """What is under the cursor is looked for in the background."""
        self.wait(lambda: self.cursor() == shape, f"the cursor does not become {shape}", 20)

    def log(self):
        """The lines of MeshLab's log so far. MeshLab prints them all; 2025.07 keeps none, once its window shows them."""
        self.marks += 1
        mark = f"gui_driver: mark {self.marks}"
        self.ask("print", text=mark)
        self.wait_output(mark)
        lines = self.output[:self.output.index(mark)]
        return [m[1] for m in (re.match(r"LOG: \d (.*)", line) for line in lines) if m]

    def on_screen(self):
        return self.ask("on_screen")["texts"]

    def history(self):
        return self.ask("history")["filters"]

    def tool(self):
        """Title of the active tool, "" if there is none, and whether it is suspended."""
        reply = self.ask("tool")
        return reply["tool"], reply["suspended"]

    def cursor(self):
        """Number of the view's cursor among Qt's shapes."""
        return self.ask("tool")["cursor"]

    def view(self, index=None, project=None):
        """Makes a project, then one of its views the current one. @return how many views there are, and which it is"""
        reply = self.ask("view", index=index, project=project)
        self.idle()
        return reply["views"], reply["current"]

    def grab(self, path):
        self.ask("grab", path=str(path))
        return path

    def resize(self, width, height):
        self.do("resize", width=width, height=height)

    def threads(self):
        return len(list(pathlib.Path(f"/proc/{self.process.pid}/task").iterdir()))

    def quit(self):
        """As a user would, changes thrown away."""
        self.ask("quit")
        self.wait_end()

    def wait_end(self):
        """Until MeshLab has ended, saying yes to what it asks; it must end well."""
        def has_ended():
            try:
                if self.dialog():
                    self.ask("answer", button="Yes")
            except AssertionError:
                if self.process.poll() is None:
                    raise
            return self.process.poll() is not None

        self.wait(has_ended, "MeshLab does not end")
        self.reader.join(5)
        if self.process.returncode != 0:
            self.fail("MeshLab did not end well")

    def wait_output(self, text):
        self.wait(lambda: self._printed(text), f"no {text!r} in MeshLab's output")

    def x_focus(self):
        """Gives the keyboard to the main window: there is no window manager that would."""
        self.idle()
        # The search fails when a window, a dialog's perhaps, goes away meanwhile.
        window = self.x("search", "--onlyvisible", "--name", "Project_", attempts=5).split()[-1]
        self.x("windowfocus", "--sync", window, attempts=5)

    def view_corner(self):
        """Upper left corner of the view on the screen."""
        return tuple(self.ask("project")["corner"])


class GuiTest(FilterHost):
    """A test case that can open MeshLab's window, and run filters without it."""
    screen = "1280x900"

    def open(self, *files, keeps=False):
        """@param keeps  whether the tool has the settings of the window before"""
        if not keeps:
            shutil.rmtree(type(self).folder / "laplacian-edit", ignore_errors=True)
        return Window(type(self).environment, type(self).folder, files)
