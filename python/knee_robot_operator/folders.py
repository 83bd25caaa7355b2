"""Names that come from a browser, and the folders in which they may mean something."""
import os
import pathlib
import re
import stat

from .answer import Refused

_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]{0,99}\Z")
# Of a file that is there already and whose name somebody else chose: any letters and signs, but no path, nothing hidden, nothing unprintable.
_FOUND_NAME = re.compile(r"[^./\\\x00-\x1f\x7f][^/\\\x00-\x1f\x7f]{0,199}\Z")
MOST_ENTRIES = 500


def plain_name(name):
    """A name without any path in it: letters, digits, '.', '_', '-', not beginning with a sign. Refused (400) otherwise."""
    if not isinstance(name, str) or not _NAME.match(name):
        raise Refused(400, "a name has letters, digits, '.', '_' and '-' only, at most 100, and begins with a letter or a digit")
    return name


class Folder:
    """The regular files of one folder with one of the endings. What a symbolic link leads out of the folder does not exist."""

    def __init__(self, path, endings, any_name=False):
        """`any_name`: files that were put there by hand count, too, whatever they are called; new ones have plain names in any case."""
        self.path = pathlib.Path(path)
        self._endings = tuple(endings)
        self._any_name = any_name

    def _may_be(self, name):
        return isinstance(name, str) and bool((_FOUND_NAME if self._any_name else _NAME).match(name)) and name.isprintable()

    def existing(self, name):
        """The path of a file of that name; Refused (404) when there is none."""
        if not self._may_be(name):
            plain_name(name)
            raise Refused(404, "there is no such file")
        if name.endswith(self._endings) and self._is_inside(self.path / name):
            return self.path / name
        raise Refused(404, f"there is no file {name} in the folder {self.path.name}")

    def new(self, name):
        """The path of a file that does not exist yet; Refused (400, 409) otherwise."""
        name = plain_name(name)
        if not name.endswith(self._endings):
            raise Refused(400, f"the name must end in {' or '.join(self._endings)}")
        if os.path.lexists(self.path / name):
            raise Refused(409, f"{name} exists already; choose another name")
        return self.path / name

    def entries(self):
        """[{name, bytes, changed}] by name; `changed` in seconds since 1970. At most MOST_ENTRIES, the newest."""
        return self.listing()[0]

    def listing(self):
        """(entries, how many older ones are not among them)."""
        found = []
        try:
            with os.scandir(self.path) as scan:
                for entry in scan:
                    if not (self._may_be(entry.name) and entry.name.endswith(self._endings)):
                        continue
                    if self._is_inside(self.path / entry.name):
                        status = entry.stat()
                        found.append({"name": entry.name, "bytes": status.st_size, "changed": status.st_mtime})
        except OSError:
            return [], 0
        newest = sorted(found, key=lambda e: e["changed"], reverse=True)[:MOST_ENTRIES]
        return sorted(newest, key=lambda e: e["name"]), len(found) - len(newest)

    def _is_inside(self, path):
        try:
            resolved = path.resolve(strict=True)
            return resolved.is_relative_to(self.path.resolve()) and stat.S_ISREG(resolved.stat().st_mode)
        except (OSError, RuntimeError):
            return False


class ReportFolders:
    """Folders of results, one per identification or comparison: DIRECTORY/report.html and what else is shown or fetched."""

    ENDINGS = (".html", ".json", ".yaml", ".svg", ".csv", ".txt", ".urdf")

    def __init__(self, path):
        self.path = pathlib.Path(path)

    def existing(self, name, file):
        folder = self.path / plain_name(name)
        if folder.is_symlink():
            raise Refused(404, f"there is no report {name}")
        return Folder(folder, self.ENDINGS).existing(file)

    def entries(self):
        """[{name, changed, files}] of the folders that hold a report, the newest first."""
        found = []
        try:
            with os.scandir(self.path) as scan:
                names = [e.name for e in scan if _NAME.match(e.name) and e.is_dir(follow_symlinks=False)]
        except OSError:
            return []
        for name in names:
            files = Folder(self.path / name, self.ENDINGS).entries()
            if any(f["name"] == "report.html" for f in files):
                found.append({"name": name, "changed": max(f["changed"] for f in files), "files": [f["name"] for f in files]})
        return sorted(found, key=lambda e: e["changed"], reverse=True)[:MOST_ENTRIES]
