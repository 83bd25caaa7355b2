"""Who may do what: users and roles, sessions, and how often a password may be tried."""
import dataclasses
import hashlib
import hmac
import os
import pathlib
import secrets
import stat
import time

import yaml

ROLES = ("look", "operate", "engineer")
_COST = {"n": 2**14, "r": 8, "p": 1}
LONGEST_PASSWORD = 200
SHORTEST_PASSWORD = 10


def may(role, needed):
    """Whether `role` includes `needed`; a role includes those before it in ROLES."""
    return role in ROLES and ROLES.index(role) >= ROLES.index(needed)


def password_hash(password, salt=None):
    """scrypt, as it stands in the users' file: "SALT$HASH", both in hexadecimal."""
    salt = salt or secrets.token_bytes(16)
    return f"{salt.hex()}${hashlib.scrypt(password.encode(), salt=salt, **_COST).hex()}"


class InputError(Exception):
    """Bad users' file or setting: one sentence with the file and how to mend it."""


class Users:
    """The users' file: `NAME: {role: look|operate|engineer, password: SALT$HASH}`, readable by its owner alone. `operator_user` writes it."""

    def __init__(self, path):
        self._path = pathlib.Path(path)
        self._version = self._look_at_file()
        self._users = self._read()
        self._nobody = password_hash(secrets.token_hex(8))

    def _read(self):
        try:
            mode = self._path.stat().st_mode
            users = yaml.safe_load(self._path.read_text())
        except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
            raise InputError(f"{self._path}: the users' file cannot be read ({error}); write one with operator_user") from None
        if stat.S_IMODE(mode) & 0o077:
            raise InputError(f"{self._path}: others may read or write the users' file; chmod 600 it")
        if not isinstance(users, dict) or not users:
            raise InputError(f"{self._path}: holds no users; write one with operator_user")
        for name, user in users.items():
            if not (isinstance(name, str) and isinstance(user, dict) and set(user) == {"role", "password"}):
                raise InputError(f"{self._path}: user '{name}' needs exactly the keys role and password")
            if user["role"] not in ROLES:
                raise InputError(f"{self._path}: user '{name}': role '{user['role']}' is none of {', '.join(ROLES)}")
            if not isinstance(user["password"], str) or user["password"].count("$") != 1:
                raise InputError(f"{self._path}: user '{name}': the password is not one that operator_user has written")
        return users

    def _look_at_file(self):
        try:
            status = self._path.stat()
        except OSError:
            return None
        return status.st_ino, status.st_mtime_ns, status.st_size

    def look(self):
        """Reads the file when it has changed; True: the users are other ones now. One that cannot be read changes nothing."""
        version = self._look_at_file()
        if version in (None, self._version):
            return False
        self._version = version
        try:
            self._users = self._read()
        except InputError:
            return False
        return True

    def mark(self, name):
        """Another one when role or password is another; empty: there is no such user."""
        user = self._users.get(name)
        return f"{user['role']} {user['password']}" if user else ""

    def role(self, name, password):
        """The role, or None when name or password are wrong; takes as long for names that do not exist. About 50 ms of processor time."""
        user = self._users.get(name)
        stored = user["password"] if user else self._nobody
        salt, _, _ = stored.partition("$")
        try:
            right = hmac.compare_digest(password_hash(password, bytes.fromhex(salt)), stored)
        except ValueError:
            return None
        return user["role"] if user and right else None


def write_user(path, name, role, password):
    """Adds or replaces one user; the file is replaced in one step and readable by its owner alone."""
    path = pathlib.Path(path)
    users = dict(Users(path)._users) if path.exists() else {}
    users[name] = {"role": role, "password": password_hash(password)}
    beside = path.with_name(path.name + ".new")
    descriptor = os.open(beside, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(descriptor, "w") as file:
        yaml.safe_dump(users, file)
    os.replace(beside, path)


@dataclasses.dataclass
class Session:
    token: str
    csrf: str
    user: str
    role: str
    ends: float
    mark: str = ""  # Users.mark() when it began


class Sessions:
    """Sessions by their cookie. When there are too many the one that ends first goes."""

    MOST = 64

    def __init__(self, lifetime_s=12 * 3600.0, clock=time.monotonic):
        self._lifetime_s, self._clock = lifetime_s, clock
        self._sessions = {}

    def open(self, user, role, mark=""):
        while len(self._sessions) >= self.MOST:
            del self._sessions[min(self._sessions.values(), key=lambda s: s.ends).token]
        session = Session(secrets.token_urlsafe(32), secrets.token_urlsafe(32), user, role, self._clock() + self._lifetime_s, mark)
        self._sessions[session.token] = session
        return session

    def find(self, token):
        session = self._sessions.get(token or "")
        if session and session.ends < self._clock():
            self.close(token)
            return None
        return session

    def keep(self, mark):
        """Closes those whose user is not what he was: `mark(user)`."""
        for session in list(self._sessions.values()):
            if session.mark != mark(session.user):
                self.close(session.token)

    def close(self, token):
        self._sessions.pop(token or "", None)


class LoginLimit:
    """After FREE failures from an address each further one doubles the time until the next try, up to LONGEST_S."""

    FREE, LONGEST_S, MOST = 5, 300.0, 1000

    def __init__(self, clock=time.monotonic):
        self._clock = clock
        self._failures = {}  # address: (how many, until when)

    def wait_s(self, address):
        return max(0.0, self._failures.get(address, (0, 0.0))[1] - self._clock())

    def failed(self, address):
        if len(self._failures) >= self.MOST and address not in self._failures:
            del self._failures[min(self._failures, key=lambda a: self._failures[a][1])]
        count = self._failures.get(address, (0, 0.0))[0] + 1
        pause = min(2.0 ** min(count - self.FREE, 20), self.LONGEST_S) if count >= self.FREE else 0.0
        self._failures[address] = (count, self._clock() + pause)

    def succeeded(self, address):
        self._failures.pop(address, None)
