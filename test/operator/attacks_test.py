#!/usr/bin/python3
"""What strangers, other sites and broken clients may try, and what comes of it."""
import asyncio
import json
import os
import pathlib
import sys
import threading
import unittest

import aiohttp
import rosunit
from page_rig import PAGE, PageTest, Rig, until_closed

from knee_robot_operator.access import InputError
from knee_robot_operator.settings import Settings

FOLDERS = {name: f"/tmp/nowhere/{name}" for name in ("references", "patients", "recordings", "reports", "log", "robot")}
NAMES_THAT_LEAVE_THE_FOLDER = ["../secret.txt", "..%2fsecret.txt", "%2e%2e/secret.txt", "..%252fsecret.txt", "/etc/passwd", "%2fetc%2fpasswd",
                               "....//secret.txt", "lift.txt%00.yaml", "..\\secret.txt", ".hidden.txt", "lift.txt/", "-rf.txt", "a" * 300 + ".txt"]


STOP = b"POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1\r\n"


class CrossSiteRequests(PageTest):
    async def test_what_was_pressed_on_a_page_before_a_stop_or_long_ago_moves_nothing_when_it_arrives(self):
        """A phone that sleeps sends its Start when it wakes up; meanwhile somebody else has pressed STOP on the tablet."""
        moving = [(f"/api/robot/{name}", {}) for name in ("enable", "approach", "resume", "home", "declare_empty", "clear_patient")]
        moving += [("/api/robot/start", {"repetitions": 1, "record": False}), ("/api/robot/load", {"file": "lift.txt"}),
                   ("/api/robot/speed", {"percent": 100}), ("/api/jobs", {"command": "check_model", "train": []})]
        for why in ("stopped", "not heard"):
            async with Rig() as rig, rig.browser() as phone, rig.browser() as tablet:
                rig.server.playing.set_speed(20.0)
                shown = rig.server.snapshot()["seen"]
                if why == "stopped":
                    await asyncio.sleep(0.01)
                    await tablet.post("/api/stop")
                else:
                    shown -= 3.1
                asked = len(rig.robot.asked)
                for path, body in moving:
                    _, answer = await phone.post(path, body, headers={"X-Seen": str(shown)})
                    self.assertFalse(answer["success"], path)
                    self.assertIn(why, answer["message"], path)
                self.assertEqual((asked, 0), (len(rig.robot.asked), rig.robot.goals))
                for path, body in (("/api/robot/pause", {}), ("/api/robot/speed", {"percent": 10}), ("/api/robot/disable", {})):
                    self.assertTrue((await phone.post(path, body, headers={"X-Seen": str(shown)}))[1]["success"], path)
                await asyncio.sleep(0.01)
                fresh = {"X-Seen": str(rig.server.snapshot()["seen"])}
                self.assertTrue((await phone.post("/api/robot/start", {"repetitions": 1, "record": False}, headers=fresh))[1]["success"])
            for stamp in ("nan", "inf", "-1", "x", "1e9"):
                async with Rig() as rig, rig.browser() as phone:
                    self.assertFalse((await phone.post("/api/robot/enable", headers={"X-Seen": stamp}))[1]["success"], stamp)

    async def test_orders_need_the_pages_token(self):
        async with Rig() as rig, rig.browser() as browser:
            for token in ("", "x" * 43, browser.token[:-1], browser.token + "ä"):
                status, _ = await browser.post("/api/robot/enable", token=token.encode("ascii", "replace").decode())
                self.assertEqual(403, status)
            self.assertEqual([], rig.robot.asked)
            self.assertEqual(200, (await browser.post("/api/robot/enable"))[0])
            self.assertEqual([("enable", {})], rig.robot.asked)

    async def test_other_origins_are_refused_with_a_token_and_for_stop_too(self):
        async with Rig() as rig, rig.browser() as browser:
            for origin in ("http://evil.example", "null", f"http://127.0.0.1:{rig.port + 1}", f"https://127.0.0.1:{rig.port}",
                           f"http://127.0.0.1:{rig.port}.evil.example"):
                for path in ("/api/robot/enable", "/api/stop", "/api/login"):
                    status, _ = await browser.post(path, headers={"Origin": origin})
                    self.assertEqual(403, status, (origin, path))
            status, _ = await browser.post("/api/robot/enable", headers={"Sec-Fetch-Site": "cross-site"})
            self.assertEqual(403, status)
            self.assertEqual([], rig.robot.asked)

    async def test_the_own_origin_is_accepted(self):
        async with Rig() as rig, rig.browser() as browser:
            status, _ = await browser.post("/api/robot/enable", headers={"Origin": rig.url, "Sec-Fetch-Site": "same-origin"})
            self.assertEqual(200, status)

    async def test_a_form_of_another_kind_is_no_order(self):
        async with Rig() as rig, rig.browser() as browser:
            async with browser.session.post(rig.url + "/api/robot/enable", data=b"{}",
                                            headers={"X-CSRF-Token": browser.token, "Content-Type": "text/plain"}) as answer:
                self.assertEqual(415, answer.status)
            self.assertEqual([], rig.robot.asked)

    async def test_a_strange_host_name_is_refused_as_dns_rebinding_has_it(self):
        async with Rig() as rig:
            for host in ("evil.example", f"evil.example:{rig.port}", "", f"127.0.0.1.evil.example:{rig.port}"):
                answer = await rig.talk(f"GET /api/session HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\n\r\n".encode())
                self.assertTrue(answer.startswith(b"HTTP/1.1 421"), (host, answer[:60]))
                self.assertNotIn(b"csrf", answer)

    async def test_another_site_cannot_listen(self):
        async with Rig() as rig, rig.browser() as browser:
            with self.assertRaises(aiohttp.WSServerHandshakeError) as refused:
                await browser.session.ws_connect(rig.url + "/api/live", headers={"Origin": "http://evil.example"})
            self.assertEqual(403, refused.exception.status)
            async with browser.session.ws_connect(rig.url + "/api/live", headers={"Origin": rig.url}) as socket:
                self.assertEqual("state", (await socket.receive_json(timeout=3))["type"])

    async def test_no_other_site_may_frame_the_page_or_run_a_script_in_it(self):
        async with Rig() as rig, rig.browser() as browser:
            await browser.get("/")
            policy = browser.headers["Content-Security-Policy"]
            for part in ("default-src 'none'", "script-src 'self'", "frame-ancestors 'none'", "base-uri 'none'"):
                self.assertIn(part, policy)
            self.assertNotIn("unsafe", policy)
            self.assertEqual("nosniff", browser.headers["X-Content-Type-Options"])


class Paths(PageTest):
    async def test_no_name_leaves_its_folder(self):
        async with Rig() as rig:
            for folder in ("exercises", "recordings", "reports/r"):
                for name in NAMES_THAT_LEAVE_THE_FOLDER:
                    answer = await rig.talk(f"GET /api/{folder}/{name} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n".encode())
                    self.assertIn(answer[9:12], (b"400", b"404"), (folder, name, answer[:80]))
                    self.assertNotIn(b"secret\n", answer + b"\n")
            for path in ("/../secret.txt", "/languages/../../secret.txt", "//etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/page.js%00.html"):
                answer = await rig.talk(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\nConnection: close\r\n\r\n".encode())
                self.assertIn(answer[9:12], (b"400", b"404"), (path, answer[:80]))

    async def test_names_in_orders_stay_in_their_folder(self):
        async with Rig() as rig, rig.browser() as browser:
            for name in ("../secret.txt", "/etc/passwd", "lift.txt\n", "lift.txt; reboot", "$(reboot).txt", "--help", "", "li\x00ft.txt"):
                for path in ("/api/robot/load", "/api/robot/patient"):
                    status, _ = await browser.post(path, {"file": name})
                    self.assertIn(status, (400, 404), (path, name))
                status, _ = await browser.post("/api/jobs", {"command": "compare", "train": [name]})
                self.assertIn(status, (400, 404), name)
            self.assertEqual([], rig.robot.asked)
            self.assertEqual([], rig.jobs.begun)

    async def test_what_a_link_leads_out_of_the_folder_does_not_exist(self):
        async with Rig() as rig, rig.browser() as browser:
            os.symlink(rig.folder / "secret.txt", rig.folder / "references" / "link.txt")
            os.symlink(rig.folder, rig.folder / "reports" / "link")
            os.mkfifo(rig.folder / "references" / "pipe.txt")
            self.assertEqual(["lift.txt"], [e["name"] for e in (await browser.get("/api/exercises"))[1]["exercises"]])
            for path in ("/api/exercises/link.txt", "/api/exercises/pipe.txt", "/api/reports/link/secret.txt"):
                self.assertEqual(404, (await browser.get(path))[0], path)
            self.assertEqual([], (await browser.get("/api/recordings"))[1]["reports"])

    async def test_a_report_draws_in_an_origin_of_its_own_and_no_other_file_runs_scripts(self):
        async with Rig() as rig, rig.browser() as browser:
            (rig.folder / "reports" / "r").mkdir()
            (rig.folder / "reports" / "r" / "report.html").write_text("<script>fetch('/api/robot/enable')</script>")
            for name, scripts in (("report.html", True), ("pose.svg", False), ("other.html", False)):
                (rig.folder / "reports" / "r" / name).write_text("<script>fetch('/api/robot/enable')</script>")
                status, _ = await browser.get(f"/api/reports/r/{name}")
                self.assertEqual(200, status)
                policy = [rule.strip() for rule in browser.headers["Content-Security-Policy"].split(";")]
                self.assertIn("sandbox allow-scripts" if scripts else "sandbox", policy, "and no allow-same-origin, -forms, -popups")
                self.assertIn("default-src 'none'", policy, "no requests")
                self.assertEqual(scripts, "script-src 'unsafe-inline'" in policy)


class Injection(PageTest):
    async def test_bodies_that_are_no_orders_are_refused_by_a_sentence(self):
        async with Rig() as rig, rig.browser() as browser:
            headers = {"X-CSRF-Token": browser.token, "Content-Type": "application/json"}
            for body in (b"", b"[]", b"null", b"{", b'{"percent": NaN}', b'{"percent": "50"}', b'{"percent": true}', b'{"percent": 1e999}',
                         b'{"percent": -5}', b'{"percent": 101}', b'{"percent": 50, "more": 1}', b'{"percent": [50]}', b"[" * 30000, b"\xff\xfe"):
                async with browser.session.post(rig.url + "/api/robot/speed", data=body, headers=headers) as answer:
                    self.assertEqual(400, answer.status, body[:40])
                    self.assertTrue((await answer.json())["message"])
            self.assertEqual([], rig.robot.asked)
            self.assertEqual(200, (await browser.post("/api/robot/speed", {"percent": 50}))[0])

    async def test_the_number_of_repetitions_is_bounded(self):
        async with Rig() as rig, rig.browser() as browser:
            for count in (0, -1, 101, 10**12, 1.5, True, "1"):
                status, _ = await browser.post("/api/robot/start", {"repetitions": count, "record": False})
                self.assertEqual(400, status, count)
            self.assertEqual(0, rig.robot.goals)

    async def test_patient_files_are_written_from_numbers_and_never_over_another(self):
        good = {"name": "p17.yaml", "patient": "17", "pose": {"X_m": [-0.1, 0.1], "Z_m": [0.6, 0.7], "theta_deg": [-5, 5], "psi_deg": [-5, 5]},
                "speed": {"linear_mm_per_s": 20, "angular_deg_per_s": 2}}
        async with Rig() as rig, rig.browser() as browser:
            for change in ({"name": "../p.yaml"}, {"name": "p.txt"}, {"patient": ""}, {"patient": "a\nspeed: {linear_mm_per_s: 900}"}, {"patient": 17},
                           {"pose": {}}, {"pose": {**good["pose"], "X_m": [0.1, -0.1]}}, {"pose": {**good["pose"], "X_m": ["!!python/object", 1]}},
                           {"speed": {"linear_mm_per_s": 0, "angular_deg_per_s": 2}}, {"speed": []}):
                status, _ = await browser.post("/api/patients", {**good, **change})
                self.assertEqual(400, status, change)
            self.assertEqual([], os.listdir(rig.folder / "patients"))
            self.assertEqual(200, (await browser.post("/api/patients", good))[0])
            self.assertEqual(409, (await browser.post("/api/patients", {**good, "patient": "18"}))[0])
            described = (await browser.get("/api/patients"))[1]["patients"]
            self.assertEqual([("17", [-0.1, 0.1])], [(p["patient"], p["pose"]["X_m"]) for p in described])

    async def test_patient_files_of_others_cannot_make_objects_or_exhaust_memory(self):
        bombs = {"object.yaml": "patient: !!python/object/apply:os.system ['touch /tmp/owned']\n", "large.yaml": "patient: " + "x" * 20000,
                 "deep.yaml": "patient: " + "[" * 5000, "list.yaml": "[1, 2]", "binary.yaml": "\x00\x01"}
        async with Rig() as rig, rig.browser() as browser:
            for name, text in bombs.items():
                (rig.folder / "patients" / name).write_text(text)
            status, content = await browser.get("/api/patients")
            self.assertEqual(200, status)
            self.assertEqual([], [p for p in content["patients"] if "problem" not in p])
            self.assertEqual({"object.yaml", "binary.yaml"}, {p["name"] for p in content["patients"]}, "files that cannot be read are named")
            self.assertFalse(pathlib.Path("/tmp/owned").exists())

    async def test_nobody_writes_somebody_elses_line_into_the_logs(self):
        async with Rig() as rig, rig.browser() as browser:
            rig.robot.say('refused\n{"kind": "request", "user": "chief"}')
            await browser.post("/api/jobs", {"command": 'x"\n{"kind":"request"}', "train": []})
            await asyncio.sleep(1.2)
            rig.server.events.settle()
            lines = (rig.folder / "log" / "events.jsonl").read_text().splitlines()
            self.assertTrue(all(json.loads(line)["kind"] in ("page", "controller") for line in lines), lines)

    def test_the_page_never_parses_what_it_shows(self):
        for file in PAGE.glob("*.js"):
            for word in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "eval(", "new Function", "srcdoc"):
                self.assertNotIn(word, file.read_text(), file.name)
        for word in ("http://", "https://"):
            self.assertNotIn(word, (PAGE / "index.html").read_text(), "works without internet")


class OversizedAndSlow(PageTest):
    async def test_large_bodies_heads_and_addresses_are_refused(self):
        async with Rig() as rig, rig.browser() as browser:
            headers = {"X-CSRF-Token": browser.token, "Content-Type": "application/json"}
            async with browser.session.post(rig.url + "/api/robot/load", data=b'{"file": "' + b"x" * 100_000 + b'"}', headers=headers) as answer:
                self.assertEqual(413, answer.status)
            for head in (b"GET /" + b"a" * 20000 + b" HTTP/1.1\r\n", b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: " + b"a" * 20000 + b"\r\n\r\n",
                         b"GET / HTTP/1.1\r\n" + b"".join(b"X%d: 1\r\n" % k for k in range(40000)) + b"\r\n"):
                answer = await rig.talk(head)
                self.assertNotIn(b" 200 ", answer[:20])
            self.assertEqual(200, (await browser.post("/api/stop"))[0])

    async def test_a_request_that_dribbles_in_is_cut_off_and_stop_gets_through(self):
        async with Rig(limits={"first_request_s": 0.4}, body_s=0.4) as rig, rig.browser() as browser:
            slow = [asyncio.open_connection("127.0.0.1", rig.port) for _ in range(20)]
            slow = await asyncio.gather(*slow)
            for _, writer in slow:
                writer.write(b"GET / HTTP/1.1\r\nHost: 127")
            self.assertEqual(200, (await browser.post("/api/stop"))[0])
            for reader, writer in slow:
                self.assertEqual(b"", await asyncio.wait_for(until_closed(reader), 5))
                writer.close()
            head = f"POST /api/robot/enable HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nX-CSRF-Token: {browser.token}\r\n"
            answer = await rig.talk(head.encode() + b"Content-Length: 100\r\n\r\n{")
            self.assertTrue(answer.startswith(b"HTTP/1.1 408"), answer[:60])
            self.assertNotIn(("enable", {}), rig.robot.asked)

    async def test_one_address_cannot_take_all_connections(self):
        async with Rig(limits={"most_per_address": 5}) as rig, rig.browser() as browser:
            other = [await asyncio.open_connection("127.0.0.1", rig.port, local_addr=("127.0.0.2", 0)) for _ in range(7)]
            for reader, _ in other[:2]:
                self.assertEqual(b"", await asyncio.wait_for(until_closed(reader), 5), "the oldest give way")
            self.assertFalse(any(reader.at_eof() for reader, _ in other[2:]))
            self.assertEqual(200, (await browser.get("/api/session"))[0])
            for _, writer in other:
                writer.close()

    async def test_connections_that_ask_nothing_give_way_to_a_stop(self):
        async with Rig(limits={"most": 30, "most_per_address": 10}) as rig:
            idle = b"GET /api/session HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n"
            dribble = b"POST /api/login HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\nContent-Length: 9\r\n\r\n{"
            held = []
            for k in range(30):
                held.append(await asyncio.open_connection("127.0.0.1", rig.port, local_addr=(f"127.0.0.{2 + k // 10}", 0)))
                held[-1][1].write((idle, dribble, b"GET /")[k % 3])
            await asyncio.sleep(0.1)
            for address in ("127.0.0.1", "127.0.0.2"):  # a new one, and one that has all it may have
                answer = await asyncio.wait_for(rig.talk(STOP + b"Content-Length: 0\r\nConnection: close\r\n\r\n", local=address), 3)
                self.assertTrue(answer.startswith(b"HTTP/1.1 200"), (address, answer[:60]))
            for _, writer in held:
                writer.close()

    async def test_stop_waits_for_no_body_whatever_it_is_said_to_be(self):
        async with Rig() as rig:
            for body in (b"Content-Length: 100\r\n\r\n{", b"Content-Length: 100000\r\n\r\n" + 100_000 * b"x", b"Transfer-Encoding: chunked\r\n\r\n"):
                rig.robot.asked.clear()
                reader, writer = await asyncio.open_connection("127.0.0.1", rig.port)
                writer.write(STOP + body)
                self.assertTrue((await asyncio.wait_for(reader.read(200), 3)).startswith(b"HTTP/1.1 200"), body[:30])
                self.assertIn(("stop", {}), rig.robot.asked)
                writer.close()

    async def test_stop_gets_through_while_the_disk_of_the_logs_hangs(self):
        async with Rig() as rig, rig.browser() as browser:
            disk, in_time = threading.Event(), []
            for journal in (rig.server.audit, rig.server.events):
                journal._handler.emit = lambda _record: in_time.append(disk.wait(5))
            self.assertEqual(200, (await asyncio.wait_for(browser.post("/api/robot/speed", {"percent": 50}), 3))[0])
            self.assertEqual(200, (await asyncio.wait_for(browser.post("/api/stop"), 3))[0])
            self.assertIn(("stop", {}), rig.robot.asked)
            disk.set()
            rig.server.audit.settle()
            self.assertTrue(in_time and all(in_time), "nobody but the log waits for the disk")

    async def test_a_page_that_does_not_read_loses_messages_and_nobody_else_does(self):
        async with Rig() as rig, rig.browser() as browser:
            async with browser.session.ws_connect(rig.url + "/api/live") as unread, browser.session.ws_connect(rig.url + "/api/live") as page:
                unread._reader.feed_data = lambda *_: None
                for k in range(2000):
                    rig.server.events.add("page", f"event {k} " + "x" * 500)
                end = asyncio.get_running_loop().time() + 5
                newest = ""
                while "event 1999" not in newest and asyncio.get_running_loop().time() < end:
                    message = await page.receive_json(timeout=3)
                    newest = message["content"].get("text", "") if message["type"] == "event" else newest
                self.assertIn("event 1999", newest)

    async def test_a_talkative_page_is_not_listened_to(self):
        async with Rig() as rig, rig.browser() as browser:
            async with browser.session.ws_connect(rig.url + "/api/live") as socket:
                await socket.send_str("x" * 5000)
                with self.assertRaises((TypeError, asyncio.TimeoutError)):
                    for _ in range(100):
                        await socket.receive_json(timeout=2)
                self.assertTrue(socket.closed)

    async def test_nonsense_on_the_wire_ends_that_connection_only(self):
        async with Rig() as rig, rig.browser() as browser:
            for data in (os.urandom(3000), b"\r\n\r\n\r\n\r\n", b"POST /api/stop HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: -5\r\n\r\n",
                         b"POST /api/robot/enable HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 2\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
                         b"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", b"GET http://evil.example/ HTTP/1.1\r\nHost: evil.example\r\n\r\n"):
                try:
                    answer = await rig.talk(data + b"\r\nConnection: close\r\n\r\n", 20)
                except asyncio.TimeoutError:
                    answer = b""
                self.assertNotIn(b" 200 ", answer[:20], data[:40])
            self.assertEqual(200, (await browser.get("/"))[0])
            self.assertNotIn(("enable", {}), rig.robot.asked)


class Exposure(unittest.TestCase):
    def test_beyond_loopback_certificate_and_users_are_needed(self):
        for address in ("0.0.0.0", "192.168.10.1", "::"):
            for more in ({}, {"users": "u.yaml"}, {"certificate": "c.pem", "key": "k.pem"}):
                with self.assertRaises(InputError, msg=(address, more)):
                    Settings(**FOLDERS, address=address, **more)
        for address in ("127.0.0.1", "::1", "127.3.2.1"):
            self.assertTrue(Settings(**FOLDERS, address=address).is_local)
        for wrong in ({"address": "localhost"}, {"port": 70000}, {"local_role": "god"}, {"certificate": "c.pem"}):
            with self.assertRaises(InputError, msg=wrong):
                Settings(**FOLDERS, **wrong)


if __name__ == "__main__":
    rosunit.unitrun("knee_robot", "operator_attacks", "attacks_test", sys.argv)
