# SPDX-License-Identifier: GPL-3.0-or-later
"""The program laplacian-edit: which files its names lead to, and what becomes of them."""
import json
import os
import stat
import unittest

from command_line_test import REFUSED, UNREADABLE, UNWRITABLE, WRONG_USAGE, CommandTest
from host import replay
from ply import write_ply

NOBODY = 54321  # an ordinary user's number


class RealFiles(CommandTest):
    def setUp(self):
        super().setUp()
        self.mesh = write_ply(self.place / "in.ply", self.points, self.faces)
        self.edit = self.write_edit(self.lift, name=self.place.name + "/edit.json")
        (self.place / "out.ply").write_text("old")
        (self.place / "out-0002.ply").write_text("old")

    def test_names_of_one_file_are_refused(self):
        for name, link in (("edit", os.symlink), ("in", os.symlink), ("out", os.symlink), ("edit", os.link),
                           ("in", os.link), ("out", os.link)):
            target = {"edit": self.edit, "in": self.mesh, "out": self.place / "out.ply"}[name]
            link(target, self.place / f"{name}_{link.__name__}")
        (self.place / "below").mkdir()
        (self.place / "folder").symlink_to(".")
        os.symlink("nowhere.ply", self.place / "dangling.ply")
        os.link(self.mesh, self.place / "all-0002.ply")
        os.symlink("two-0002.ply", self.place / "two-0001.ply")
        for arguments in (
                ("edit.json", "edit.json"), ("edit_symlink", "edit.json"), ("edit_link", "edit.json"),
                ("edit.json", "edit_symlink"), ("below/../folder/edit.json", "edit.json"),
                *(("out.ply", "edit.json", "--report", report) for report in (
                    "in.ply", "in_symlink", "in_link", "edit.json", "edit_symlink", "edit_link", "out.ply", "out_symlink",
                    "out_link", "folder/out.ply")),
                ("dangling.ply", "edit.json", "--report", "nowhere.ply"),
                ("new.ply", "edit.json", "--report", "folder/new.ply"),
                ("out.ply", "edit.json", "--fractions", "0,1", "--report", "out-0002.ply"),
                ("all.ply", "edit.json", "--fractions", "0,1"), ("two.ply", "edit.json", "--fractions", "0,1")):
            with self.subTest(arguments):
                self.refused(WRONG_USAGE, r'\AThe \w+ ".*" and the (output|report) ".*" are the same file: give another name',
                             self.mesh, *arguments)

    def test_links_that_lead_nowhere_are_followed(self):
        (self.place / "elsewhere").mkdir()
        (self.place / "first.ply").symlink_to("second.ply")
        (self.place / "second.ply").symlink_to("elsewhere/real.ply")
        self.done(self.mesh, "first.ply", "edit.json")
        self.assertTrue((self.place / "first.ply").is_symlink() and (self.place / "second.ply").is_symlink())
        self.assertEqual(self.bits(self.place / "elsewhere" / "real.ply"), self.edited_bits(self.edit))
        (self.place / "circle.ply").symlink_to("circle.ply")
        self.refused(WRONG_USAGE, r"circle\.ply.* is a link to itself", self.mesh, "circle.ply", "edit.json")
        (self.place / "lost.ply").symlink_to("none/real.ply")
        self.refused(UNWRITABLE, r"lost\.ply.* folder does not exist", self.mesh, "lost.ply", "edit.json")

    def test_paths_go_by_the_links_that_they_name(self):
        """What follows a link and ".." is beside the folder that the link leads to."""
        (self.place / "there" / "sub").mkdir(parents=True)
        (self.place / "link").symlink_to("there/sub")
        for path in (self.mesh, self.edit):
            path.rename(self.place / "there" / path.name)
        self.done("link/../in.ply", "link/../out.ply", "link/../edit.json", "--report", "link/../report.json")
        self.assertEqual((self.place / "out.ply").read_text(), "old")
        self.assertEqual({path.name for path in (self.place / "there").iterdir()},
                         {"sub", "in.ply", "edit.json", "out.ply", "report.json"})

    def test_permissions_are_handed_down_but_not_the_right_to_be_another_user(self):
        out = self.place / "out.ply"
        for mode, after in ((0o640, 0o640), (0o6775, 0o775), (0o1604, 0o604)):
            out.chmod(mode)
            self.done(self.mesh, out, "edit.json")
            self.assertEqual(stat.S_IMODE(out.stat().st_mode), after)

    @unittest.skipUnless(os.geteuid() == 0, "takes root's rights to give files away")
    def test_owner_and_group_are_kept(self):
        out = self.place / "out.ply"
        os.chown(out, NOBODY, NOBODY + 1)
        out.chmod(0o4664)
        self.done(self.mesh, out, "edit.json", "--report", "report.json")
        found = out.stat()
        self.assertEqual((found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)), (NOBODY, NOBODY + 1, 0o664))

    def test_group_that_cannot_be_kept_hands_nothing_to_another(self):
        if os.geteuid() != 0:
            self.skipTest("takes root's rights to give files away")
        self.folder.chmod(0o755)
        self.place.chmod(0o777)
        self.mesh.chmod(0o644)
        out = self.place / "out.ply"
        out.chmod(0o664)

        def become_nobody():
            os.setgroups([])
            os.setgid(NOBODY)
            os.setuid(NOBODY)
        try:
            self.done(self.mesh, out, "edit.json", preexec_fn=become_nobody)
        except PermissionError:
            self.skipTest("the program is where other users cannot start it")
        found = out.stat()
        self.assertEqual((found.st_uid, found.st_gid, stat.S_IMODE(found.st_mode)), (NOBODY, NOBODY, 0o644))

    def test_place_that_becomes_a_folder_meanwhile(self):
        for name, sentence, written in (("all-0003.ply", r"output .*all-0003\.ply.* has become a folder\.\n\Z", 0),
                                        ("report.json", r"report .*report\.json.* has become a folder\. "
                                                        r"The outputs are complete\.\n\Z", 400)):
            with self.writing("--report", "report.json") as process:
                (self.place / name).mkdir()
                _, errors = process.communicate(timeout=60)
            self.assertEqual(process.returncode, UNWRITABLE)
            self.assertRegex(errors.decode(), sentence)
            (self.place / name).rmdir()
            self.assertEqual(len(list(self.place.glob("all-*"))), written)
            self.assertEqual(list(self.place.glob(".lap*")), [])


class Names(CommandTest):
    def test_names_are_bytes(self):
        bits = self.edited_bits(self.edit)
        folder = os.fsencode(self.place) + b"/d\xff \xe5\xb1"
        os.mkdir(folder)
        data = {b"in\xfe.ply": self.mesh.read_bytes(), b"edit\x80\xed\xb2\x80.json": self.edit.read_bytes(),
                b"script\xc3.mlx": self.write_script(replay(self.lift)).read_bytes()}
        for name, content in data.items():
            with open(folder + b"/" + name, "wb") as file:
                file.write(content)
        mesh, edit, script = (folder + b"/" + name for name in data)
        for out, given in ((b"out\xff.ply", edit), (b"plain.ply", edit), ("Höcker\udcff.ply".encode(errors="surrogateescape"),
                                                                        script)):
            self.done(mesh, folder + b"/" + out, given, "--report", folder + b"/report\xa0.json", "--quiet")
            self.assertEqual(self.bits(folder + b"/" + out), bits)
            with open(folder + b"/report\xa0.json", "rb") as file:
                report = json.load(file)
            self.assertEqual(os.fsencode(report["input"]), mesh)
            self.assertEqual(os.fsencode(report["outputs"][0]["file"]), folder + b"/" + out)
        self.done(mesh, folder + b"/all\xff.off", edit, "--fractions", "0.5,1")
        self.assertEqual(sorted(os.listdir(folder)), sorted([
            *data, b"out\xff.ply", b"plain.ply", b"H\xc3\xb6cker\xff.ply", b"report\xa0.json", b"all\xff-0001.off",
            b"all\xff-0002.off"]))
        self.refused(WRONG_USAGE, r"are the same file", mesh, edit, edit)
        self.refused(UNREADABLE, r"mesh .*none.* does not exist", folder + b"/none\xff.ply", "out.ply", edit)

    def piped(self, text):
        end, other_end = os.pipe()
        os.write(other_end, text)
        os.close(other_end)
        return end

    def test_edit_may_come_from_a_pipe(self):
        bits = self.edited_bits(self.edit)
        for source in (self.edit, self.write_script(replay(self.lift))):
            for name in ("/dev/stdin", "/dev/fd/0", "/proc/self/fd/0"):
                end = self.piped(source.read_bytes())
                self.done(self.mesh, "out.ply", name, stdin=end)
                os.close(end)
                self.assertEqual(self.bits(self.place / "out.ply"), bits)
        with open(self.edit, "rb") as file:
            self.refused(WRONG_USAGE, r"are the same file", self.mesh, self.edit, "/dev/stdin", stdin=file)
        end = self.piped(b'{"laplacian_edit": 1,')
        self.refused(REFUSED, r"line 1", self.mesh, "out.ply", "/dev/stdin", stdin=end)
        os.close(end)


if __name__ == "__main__":
    unittest.main()
