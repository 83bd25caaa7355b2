#!/usr/bin/python3
"""Login, roles, sessions and the audit log."""
import asyncio
import os
import pathlib
import sys
import tempfile
import unittest

import aiohttp
import rosunit
import yaml
from page_rig import PageTest, Rig

from knee_robot_operator.access import InputError, LoginLimit, Sessions, Users, may, write_user
from knee_robot_operator.requests import PLAIN

PASSWORD = "correct horse battery"


class Roles(PageTest):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="operator_users_")
        self.users = pathlib.Path(self._folder.name) / "users.yaml"
        for role in ("look", "operate", "engineer"):
            write_user(self.users, f"{role}er", role, PASSWORD)

    def tearDown(self):
        self._folder.cleanup()

    async def test_without_a_login_nothing_is_seen_but_the_page_and_stop_works(self):
        async with Rig(users=str(self.users)) as rig, rig.browser() as browser:
            self.assertEqual({"login": True}, (await browser.get("/api/session"))[1])
            for path in ("exercises", "exercises/lift.txt", "patients", "recordings", "events", "audit"):
                self.assertEqual(401, (await browser.get(f"/api/{path}"))[0], path)
            with self.assertRaises(aiohttp.WSServerHandshakeError):
                await browser.session.ws_connect(rig.url + "/api/live")
            for path in (*(f"robot/{name}" for name in PLAIN), "robot/start", "robot/speed", "robot/load", "jobs", "model", "patients"):
                self.assertEqual(401, (await browser.post(f"/api/{path}"))[0], path)
            self.assertEqual([], rig.robot.asked)
            self.assertEqual(200, (await browser.get("/"))[0])
            self.assertEqual((200, True), ((answer := await browser.post("/api/stop"))[0], answer[1]["success"]))
            self.assertEqual(["stop"], [service for service, _ in rig.robot.asked])

    async def test_each_role_may_do_what_it_may_and_stop_is_for_all(self):
        async with Rig(users=str(self.users)) as rig:
            for role in ("look", "operate", "engineer"):
                async with rig.browser(f"{role}er", PASSWORD) as browser:
                    for name, needed in PLAIN.items():
                        expected = 200 if may(role, needed) else 403
                        self.assertEqual(expected, (await browser.post(f"/api/robot/{name}"))[0], (role, name))
                    self.assertEqual(200 if role != "look" else 403, (await browser.post("/api/robot/speed", {"percent": 50}))[0])
                    self.assertEqual(200 if role == "engineer" else 403, (await browser.get("/api/audit"))[0])
                    for command, needed in (("compare", "operate"), ("trace", "engineer"), ("check_model", "engineer")):
                        status, _ = await browser.post("/api/jobs", {"command": command, "train": []})
                        self.assertEqual(200 if may(role, needed) else 403, status, (role, command))
                    self.assertEqual(200, (await browser.post("/api/stop"))[0])
                    self.assertEqual(200, (await browser.post("/api/robot/emergency_stop"))[0])

    async def test_whoever_is_removed_or_gets_another_role_or_password_moves_nothing_any_more(self):
        async with Rig(users=str(self.users)) as rig:
            async with rig.browser("operateer", PASSWORD) as removed, rig.browser("engineerer", PASSWORD) as demoted, \
                    rig.browser("looker", PASSWORD) as stays:
                left = yaml.safe_load(self.users.read_text())
                del left["operateer"]
                self.users.write_text(yaml.safe_dump(left))
                write_user(self.users, "engineerer", "look", PASSWORD)
                for _ in range(50):
                    await asyncio.sleep(0.1)
                    status = (await removed.post("/api/robot/approach"))[0]
                    if status == 401:
                        break
                self.assertEqual(401, status)
                self.assertEqual(401, (await demoted.post("/api/robot/approach"))[0])
                self.assertEqual(200, (await stays.get("/api/exercises"))[0])
                self.assertEqual(401, (await removed.post("/api/login", {"user": "operateer", "password": PASSWORD}))[0])
                self.users.write_text("half: {ro")  # nobody is locked out by a file that is just being written
                await asyncio.sleep(2.5)
                self.assertEqual(200, (await stays.get("/api/exercises"))[0])

    async def test_wrong_passwords_are_slowed_down_and_stop_is_not(self):
        async with Rig(users=str(self.users)) as rig, rig.browser() as browser:
            statuses = [(await browser.post("/api/login", {"user": "operateer", "password": f"wrong {k}"}))[0] for k in range(8)]
            self.assertEqual([401] * 5, statuses[:5])
            self.assertIn(429, statuses[5:])
            self.assertEqual(200, (await browser.post("/api/stop"))[0])
            for entry in rig.audit():
                self.assertNotIn("wrong 0", str(entry))

    async def test_the_cookie_is_out_of_reach_of_scripts_and_other_sites_and_ends_with_the_logout(self):
        async with Rig(users=str(self.users)) as rig, rig.browser() as browser:
            async with browser.session.post(rig.url + "/api/login", json={"user": "operateer", "password": PASSWORD}) as answer:
                cookie = answer.headers["Set-Cookie"]
            self.assertIn("HttpOnly", cookie)
            self.assertIn("SameSite=Strict", cookie)
            await browser.fetch_token()
            async with browser.session.ws_connect(rig.url + "/api/live") as socket:
                await socket.receive_json(timeout=3)
                self.assertEqual(200, (await browser.post("/api/logout"))[0])
                with self.assertRaises((TypeError, asyncio.TimeoutError)):
                    for _ in range(100):
                        await socket.receive_json(timeout=5)
            self.assertEqual(401, (await browser.get("/api/exercises"))[0])

    async def test_the_audit_log_says_who_asked_what_from_where_and_the_answer(self):
        async with Rig(users=str(self.users)) as rig, rig.browser("operateer", PASSWORD) as browser:
            await browser.post("/api/robot/speed", {"percent": 40})
            await browser.get("/api/audit")
            await browser.post("/api/model", {"report": "r"})
            entries = rig.audit()
            asked = [e for e in entries if e["text"] == "speed 40 %"]
            self.assertEqual([("operateer", "operate", "127.0.0.1", "request")], [(e["user"], e["role"], e["address"], e["kind"]) for e in asked])
            self.assertEqual(2, sum(e["kind"] == "refused" and "engineer" in e["text"] for e in entries), entries)


class OverTls(PageTest):
    async def test_the_page_is_served_over_tls_with_a_secure_cookie(self):
        with tempfile.TemporaryDirectory(prefix="operator_tls_") as name:
            folder = pathlib.Path(name)
            write_user(folder / "users.yaml", "ana", "operate", PASSWORD)
            process = await asyncio.create_subprocess_exec(
                "openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "1", "-subj", "/CN=robot",
                "-keyout", folder / "key.pem", "-out", folder / "cert.pem", stderr=asyncio.subprocess.DEVNULL)
            self.assertEqual(0, await process.wait())
            async with Rig(users=str(folder / "users.yaml"), certificate=str(folder / "cert.pem"), key=str(folder / "key.pem")) as rig:
                async with rig.browser() as browser:
                    async with browser.session.post(rig.url + "/api/login", json={"user": "ana", "password": PASSWORD}) as answer:
                        self.assertIn("Secure", answer.headers["Set-Cookie"])
                        self.assertIn("max-age", answer.headers["Strict-Transport-Security"])
                plain = await rig.talk(b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
                self.assertNotIn(b"200 OK", plain)


class UsersFile(unittest.TestCase):
    def setUp(self):
        self._folder = tempfile.TemporaryDirectory(prefix="operator_users_")
        self.file = pathlib.Path(self._folder.name) / "users.yaml"

    def tearDown(self):
        self._folder.cleanup()

    def write(self, text, mode=0o600):
        self.file.write_text(text)
        os.chmod(self.file, mode)

    def test_a_user_is_known_by_name_and_password_only(self):
        write_user(self.file, "ana", "operate", PASSWORD)
        write_user(self.file, "eva", "look", PASSWORD + "!")
        users = Users(self.file)
        self.assertEqual("operate", users.role("ana", PASSWORD))
        for name, password in (("ana", PASSWORD + "!"), ("eva", PASSWORD), ("nobody", PASSWORD), ("", ""), ("ana", "")):
            self.assertIsNone(users.role(name, password))
        self.assertNotIn(PASSWORD, self.file.read_text())
        self.assertEqual(0o600, self.file.stat().st_mode & 0o777)

    def test_files_that_others_can_read_or_that_make_no_sense_are_refused(self):
        write_user(self.file, "ana", "operate", PASSWORD)
        good = self.file.read_text()
        for text, mode in ((good, 0o644), (good, 0o620), ("", 0o600), ("[]", 0o600), ("ana: {role: god, password: a$b}", 0o600),
                           ("ana: {role: look}", 0o600), ("ana: {role: look, password: plain}", 0o600), ("a: [", 0o600)):
            self.write(text, mode)
            with self.assertRaises(InputError, msg=text):
                Users(self.file)

    def test_sessions_end_and_are_bounded(self):
        now = [0.0]
        sessions = Sessions(lifetime_s=10.0, clock=lambda: now[0])
        first = sessions.open("ana", "look")
        self.assertIs(first, sessions.find(first.token))
        self.assertIsNone(sessions.find(first.token[:-1]))
        self.assertIsNone(sessions.find(None))
        now[0] = 10.5
        self.assertIsNone(sessions.find(first.token))
        kept = [sessions.open("ana", "look") for _ in range(Sessions.MOST + 1)]
        self.assertIsNone(sessions.find(kept[0].token))
        self.assertIsNotNone(sessions.find(kept[-1].token))

    def test_failures_cost_more_and_more_time(self):
        now = [0.0]
        limit = LoginLimit(clock=lambda: now[0])
        waits = []
        for _ in range(20):
            limit.failed("a")
            waits.append(limit.wait_s("a"))
        self.assertEqual([0.0] * 4, waits[:4])
        self.assertEqual(LoginLimit.LONGEST_S, waits[-1])
        self.assertEqual(0.0, limit.wait_s("b"))
        limit.succeeded("a")
        self.assertEqual(0.0, limit.wait_s("a"))


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_access", "access_test", sys.argv)
