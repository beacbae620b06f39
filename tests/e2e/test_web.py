"""The operators' page: real service, real server, real sockets."""

import gzip
import http.client
import json
import os
import pwd
import re
import secrets
import signal
import socket
import sqlite3
import ssl
import subprocess
import sys
import threading
import unittest

import plant
from harness import BIN, DEADLINE_S, EndToEnd, wait_until


class WebCase(EndToEnd):
    """A service, the page's server, and requests to it."""

    def start_web(self, *options, name="web", user=None, config="reident.toml"):
        web = self.start("reident-web", "--config", self.folder / config, "--port", 0, *options,
                         name=name, user=user)
        wait_until(lambda: "url=" in web.text() or not web.running(), "reident-web serves")
        self.assertTrue(web.running(), web.text())
        self.port = int(re.search(r"url=\S*:(\d+)/", web.text())[1])
        return web

    def request(self, path, method="GET", headers=(), body=None):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=DEADLINE_S)
        try:
            connection.request(method, path, body, dict(headers))
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def get(self, path, status=200):
        got, _, body = self.request(path)
        self.assertEqual(got, status, body)
        return json.loads(body)

    def api(self, view, status=200, **parameters):
        from urllib.parse import urlencode
        return self.get(f"/api/v1/{view}?{urlencode(parameters)}", status)

    def flown(self, **changes):
        """A service that has judged windows of two plants."""
        self.configure([plant.equipment(**changes)])
        daemon = self.start_daemon()
        self.replay_rows("first", count=1900)
        return daemon

    def schema_of(self, document, schema):
        while "$ref" in schema:
            schema = document["components"]["schemas"][schema["$ref"].rsplit("/", 1)[1]]
        return schema

    def conforms(self, document, schema, value, where):
        schema = self.schema_of(document, schema)
        if "anyOf" in schema:
            return any(self.matches(document, one, value) for one in schema["anyOf"]) or \
                self.fail(f"{where}: {value!r} is none of {schema}")
        types = schema.get("type")
        types = [types] if isinstance(types, str) else types or []
        is_type = {"string": isinstance(value, str), "null": value is None,
                   "boolean": isinstance(value, bool), "object": isinstance(value, dict),
                   "array": isinstance(value, list),
                   "integer": isinstance(value, int) and not isinstance(value, bool),
                   "number": isinstance(value, (int, float)) and not isinstance(value, bool)}
        self.assertTrue(any(is_type[one] for one in types), f"{where}: {value!r} is no {types}")
        if isinstance(value, dict):
            properties = schema.get("properties", {})
            for key in schema.get("required", []):
                self.assertIn(key, value, where)
            for key, member in value.items():
                if key in properties:
                    self.conforms(document, properties[key], member, f"{where}.{key}")
                elif schema.get("additionalProperties") is False:
                    self.fail(f"{where} has {key}, which openapi.json does not have")
                elif isinstance(schema.get("additionalProperties"), dict):
                    self.conforms(document, schema["additionalProperties"], member, f"{where}.{key}")
        if isinstance(value, list) and "items" in schema:
            for index, member in enumerate(value):
                self.conforms(document, schema["items"], member, f"{where}[{index}]")
        if "enum" in schema:
            self.assertIn(value, schema["enum"], where)
        return True

    def matches(self, document, schema, value):
        try:
            return self.conforms(document, schema, value, "")
        except AssertionError:
            return False

    def with_accounts(self):
        """A service with versions that wait, and Ana (approver), Olaf (operator) and Vic (viewer)."""
        self.flown(approval="by_hand")
        lines = []
        for name, role in (("Ana", "approver"), ("Bo", "approver"), ("Olaf", "operator"),
                           ("Vic", "viewer")):
            hashed = subprocess.run([str(BIN / "reident-web"), "--hash-password"], text=True,
                                    input=f"{name}'s secret\n", capture_output=True, check=True)
            lines += ["[[account]]", f'name = "{name}"', f'role = "{role}"',
                      f'password = "{hashed.stdout.strip()}"']
        accounts = self.folder / "accounts.toml"
        accounts.write_text("\n".join(lines))
        self.options = ["--accounts", accounts, "--audit", self.folder / "audit.jsonl", "--fleet",
                        self.site()]
        return self.start_web(*self.options)

    def site(self):
        """The folder of a site: this service, and thirty that were never started."""
        site = self.folder / "site"
        site.mkdir()
        text = (self.folder / "reident.toml").read_text()
        (site / "SAT.toml").write_text(text.replace('"reident.db"', f'"{self.folder}/reident.db"'))
        for number in range(30):
            (site / f"SAT-{number}.toml").write_text(
                text.replace('"reident.db"', f'"{site}/{number}.db"'))
        return site

    def post(self, path, body, cookie="", token="", origin=None):
        status, headers, answer = self.request(
            f"/api/v1/{path}", "POST", body=json.dumps(body), headers={
                "Content-Type": "application/json", "Cookie": cookie, "X-Reident-Token": token,
                "Origin": origin or f"http://127.0.0.1:{self.port}"})
        return status, headers, json.loads(answer)

    def log_in(self, name):
        status, headers, answer = self.post("login", {"name": name, "password": f"{name}'s secret"})
        self.assertEqual(status, 200, answer)
        cookie = headers["Set-Cookie"].split(";")[0]
        self.assertIn("HttpOnly", headers["Set-Cookie"])
        _, _, body = self.request("/api/v1/session", headers={"Cookie": cookie})
        session = json.loads(body)
        self.assertEqual(session["user"], name)
        return {"cookie": cookie, "token": session["token"]}


class Web(WebCase):
    def test_every_answer_is_as_the_document_for_programs_says(self):
        self.flown()
        self.start_web("--fleet", self.site())
        document = self.get("/openapi.json")
        version = str(self.champion())
        values = {"spacecraft": "SAT", "equipment": "PLANT", "parameter": "out", "version": version}
        for path, methods in document["paths"].items():
            for operation in methods.values():
                if "requestBody" in operation:
                    continue
                asked = {one["name"]: values[one["name"]] for one in operation["parameters"]
                         if one["required"]}
                answer = self.api(path.removeprefix("/api/v1/"), **asked)
                schema = operation["responses"]["200"]["content"]["application/json"]["schema"]
                self.conforms(document, schema, answer, path)
        for view, parameters, status in (
                ("equipment", {}, 404), ("equipment", {"spacecraft": "SAT", "equipment": "X"}, 404),
                ("version", {**values, "version": "999"}, 404),
                ("version", {**values, "version": "x"}, 400),
                ("version", {**values, "version": ""}, 400), ("run", {**values, "version": ""}, 400),
                ("telemetry", {"spacecraft": "SAT", "parameter": "X"}, 404),
                ("telemetry", {**values, "bins": "0"}, 400),
                ("telemetry", {**values, "begin": "tomorrow"}, 400),
                ("run", {**values, "begin": "1900-01-01"}, 400),
                ("events", {"kind": "x"}, 400)):
            answer = self.api(view, status, **parameters)
            self.conforms(document, {"$ref": "#/components/schemas/Error"}, answer, view)

    def test_a_site_is_shown_the_worst_first(self):
        self.flown()
        self.start_web()
        self.assertFalse(self.api("session")["has_fleet"])
        self.assertIn("--fleet", self.api("fleet", 404)["error"]["message"])
        self.start_web("--fleet", self.site(), name="of-the-site")
        self.assertTrue(self.api("session")["has_fleet"])
        *others, best = self.api("fleet")["instances"]
        self.assertEqual((best["instance"], best["service"], best["with_champion"], best["act"]),
                         ("SAT", True, 1, False))
        self.assertEqual(len(others), 30)
        for one in others:
            self.assertTrue(one["act"])
            self.assertIn("is not there", one["note"])
        (self.folder / "empty").mkdir()
        self.start_web("--fleet", self.folder / "empty", name="of-nothing")
        self.assertIn("no configuration", self.api("fleet", 404)["error"]["message"])

    def test_it_shows_what_the_service_decided(self):
        self.flown()
        self.start_web()
        (line,) = self.api("overview")["equipment"]
        self.assertEqual((line["equipment"], line["champion"]), ("PLANT", str(self.champion())))
        shown = {one["version"]: one["status"] for one in
                 self.api("equipment", spacecraft="SAT", equipment="PLANT")["versions"]}
        stored = {str(version): status for version, status in
                  self.query("SELECT version, status FROM model_version")}
        self.assertEqual(shown, stored)
        status, text = self.reident("why", f"SAT/PLANT@{line['champion']}", "--json", "--config",
                                    self.folder / "reident.toml")
        self.assertEqual(status, 0, text)
        version = self.api("version", spacecraft="SAT", equipment="PLANT", version=line["champion"])
        self.assertEqual(version["verdict"], json.loads(text)["verdict"])
        self.assertEqual(version["conditions"], json.loads(text)["conditions"])
        events = self.api("events")["events"]
        self.assertEqual([one["id"] for one in events],
                         [str(one) for one, in
                          self.query("SELECT id FROM decision ORDER BY id DESC LIMIT 100")])

    def test_extremes_are_those_of_the_samples_to_the_bit_and_gaps_and_what_is_excluded_are_named(self):
        self.configure([plant.equipment()], relations=[
            {"name": "pair", "expression": "out - load", "tolerance": 0.1}])
        self.start_daemon()
        rows = [row for row in plant.rows(count=1900) if not 700 <= row[0] - plant.START_S < 800]
        rows[5][3] = 1e300
        csv = plant.write(self.folder / "gap.csv", rows)
        self.replay_all(plant.write(self.folder / "lost.csv", rows[:20]), "--wait-readers", 1,
                        spacecraft="LOST")
        self.replay_all(csv, "--wait-readers", 1)
        self.wait_idle()
        self.start_web()
        begin, end = plant.START_S, plant.START_S + 1900
        for bins in (7, 100, 4000):
            answer = self.api("telemetry", spacecraft="SAT", parameter="out", begin=begin, end=end,
                              bins=bins)
            stored = [(at, value) for (parameter, at), (value, _) in sorted(self.samples().items())
                      if parameter == "out"]
            length = round(answer["bin_s"] * 1e9)
            expected = {}
            for at, value in stored:
                expected.setdefault(at // length, []).append((value, (at - begin * 10**9) / 1e9))
            expected = [expected[key] for key in sorted(expected)]
            self.assertEqual(answer["least"], [min(one)[0] for one in expected])
            self.assertEqual(answer["greatest"], [max(one)[0] for one in expected])
            self.assertEqual(answer["samples"], [len(one) for one in expected])
            for at, value, bin_samples in zip(answer["least_s"], answer["least"], expected):
                self.assertIn((value, at), bin_samples)
            if answer["bin_s"] <= 100:
                self.assertEqual(answer["gaps"], [[699, 800]])
        found = self.api("gaps", begin=begin, end=end)
        self.assertEqual([(one["spacecraft"], one["seconds"], sorted(one["parameters"]), one["of"])
                          for one in found["gaps"]], [("LOST", 1880, ["drive", "load", "out"], 3),
                                                      ("SAT", 101, ["drive", "load", "out"], 3)])
        self.assertEqual(found["left_out"], 0)
        self.assertEqual(self.api("gaps", begin=begin, end=begin + 10)["gaps"], [])
        excluded = self.api("excluded", begin=begin, end=end)["excluded"]
        self.assertEqual({(one["check"], one["relation"], *one["parameters"], *one["equipment"])
                          for one in excluded}, {("relation", "pair", "out", "load", "PLANT"),
                                             ("fill", "", "out", "PLANT")})
        self.assertEqual([one["lasts"] for one in excluded][0], True)
        self.assertEqual(self.api("excluded", begin=end + 10**6, end=end + 10**6 + 1)["excluded"], [])

    def test_what_is_decided_comes_as_an_event_and_a_viewer_who_was_away_gets_the_newest(self):
        self.flown(approval="by_hand")
        self.start_web()
        stream = socket.create_connection(("127.0.0.1", self.port), DEADLINE_S)
        self.addCleanup(stream.close)
        stream.sendall(b"GET /api/v1/stream HTTP/1.1\r\nHost: localhost\r\n\r\n")
        heard = b""

        def hear():
            nonlocal heard
            stream.settimeout(0.05)
            try:
                heard += stream.recv(1 << 16)
            except TimeoutError:
                pass
            return heard

        wait_until(lambda: b'"equipment":"PLANT"' in hear(), "the state now")
        wait_until(lambda: b"event: service" in hear(), "the heartbeat")
        version = self.query("SELECT min(version) FROM model_version WHERE status = 'waiting'")[0][0]
        heard = b""
        status, text = self.reident("approve", "PLANT", version, "--reason", "seen", "--actor", "Ana",
                                    "--config", self.folder / "reident.toml")
        self.assertEqual(status, 0, text)
        decision = self.query("SELECT max(id) FROM decision")[0][0]
        wait_until(lambda: f'"decision":"{decision}"'.encode() in hear(), "the decision")
        last = re.findall(rb"id: (\d+)", heard)[-1].decode()
        self.assertEqual(self.api("overview")["equipment"][0]["champion"], str(version))
        changes = self.get(f"/api/v1/changes?since={int(last) - 10**6}")["changes"]
        keys = [(one["event"], one["data"].get("service") or one["data"].get("equipment"))
                for one in changes]
        self.assertEqual(len(keys), len(set(keys)), "each thing once")

    def test_the_page_comes_whole_compressed_and_once(self):
        self.configure([plant.equipment()])
        self.start_web()
        total = 0
        for path in ("/", "/page.js", "/page.css", "/icon.svg"):
            status, headers, plain = self.request(path)
            self.assertEqual(status, 200)
            self.assertNotIn("Content-Encoding", headers)
            status, headers, packed = self.request(path, headers={"Accept-Encoding": "br, gzip;q=0.5"})
            if headers.get("Content-Encoding") == "gzip":
                self.assertEqual(gzip.decompress(packed), plain)
            else:
                self.assertEqual(packed, plain)
            total += len(packed)
            self.assertNotIn("unsafe", headers["Content-Security-Policy"])
            status, _, body = self.request(path, headers={"If-None-Match": headers["ETag"]})
            self.assertEqual((status, body), (304, b""))
            status, head, body = self.request(path, method="HEAD")
            self.assertEqual((status, int(head["Content-Length"]), body), (200, len(plain), b""))
        self.assertLessEqual(total, 90_000)
        self.assertEqual(self.request("/nothing")[0], 404)

    def raw(self, text):
        """All that comes until the server ends the connection."""
        with socket.create_connection(("127.0.0.1", self.port), DEADLINE_S) as connection:
            connection.sendall(text)
            got = b""
            while more := connection.recv(1 << 16):
                got += more
            return got

    def test_hostile_bytes_get_a_refusal_and_cost_nothing(self):
        self.configure([plant.equipment()])
        web = self.start_web()
        for text, status in (
                (b"GET / HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n", 400),
                (b"GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n", 421),
                (b"GET /" + b"a" * 9000 + b" HTTP/1.1\r\nHost: localhost\r\n\r\n", 431),
                (b"POST /api/v1/orders HTTP/1.1\r\nHost: localhost\r\nContent-Length: 5000\r\n\r\n"
                 + b"a" * 5000, 413),
                (b"DELETE / HTTP/1.1\r\nHost: localhost\r\n\r\n", 405),
                (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\r\n\r\n", 400)):
            self.assertEqual(int(self.raw(text).split()[1]), status, text[:60])
        self.assertTrue(web.running())
        self.assertEqual(self.request("/livez")[0], 200)

    def test_connections_beyond_the_limit_end_at_once_and_idle_ones_soon(self):
        self.configure([plant.equipment()])
        self.start_web("--max-connections-of-address", 5)
        idle = [socket.create_connection(("127.0.0.1", self.port), DEADLINE_S) for _ in range(5)]
        try:
            self.assertEqual(self.raw(b""), b"", "the sixth")
            idle[0].sendall(b"GET / HT")
            for one in idle:
                self.assertEqual(one.recv(1), b"", "closed by the server")
        finally:
            for one in idle:
                one.close()
        wait_until(lambda: self.request("/livez")[0] == 200, "there is room again")

    def test_readiness_follows_the_service(self):
        self.configure([plant.equipment()])
        self.start_web()
        self.assertEqual(self.request("/readyz")[0], 503)
        self.assertEqual(self.request("/livez")[0], 200)
        daemon = self.start_daemon()
        wait_until(lambda: self.request("/readyz")[0] == 200, "ready")
        self.assertIn(b"[+] heartbeat", self.request("/readyz?verbose")[2])
        daemon.kill()
        wait_until(lambda: self.request("/readyz")[0] == 503, "not ready", 10)
        self.assertIn(b"[-] heartbeat", self.request("/readyz?verbose")[2])
        self.assertEqual(self.request("/livez")[0], 200)
        self.start_daemon()
        wait_until(lambda: self.request("/readyz")[0] == 200, "ready again", 10)

    def test_an_open_address_without_a_certificate_and_wrong_files_are_refused(self):
        config = self.configure([plant.equipment()])
        for options, named in ((["--address", "0.0.0.0"], "--certificate"),
                               (["--address", "example.org"], "127.0.0.1"),
                               (["--certificate", "/nonexistent.pem"], "/nonexistent.pem"),
                               (["--socket", str(config)], str(config))):
            web = self.start("reident-web", "--config", config, "--port", 0, *options)
            self.assertEqual(web.wait(), 2)
            self.assertIn(named, web.text())

    # -- who may what

    def waiting(self):
        return [str(version) for version, in self.query(
            "SELECT version FROM model_version WHERE status = 'waiting' ORDER BY version")]

    def order(self, version, action="approve", champion=None, requester=None):
        return {"requester": requester or secrets.token_hex(16), "action": action,
                "spacecraft": "SAT", "equipment": "PLANT", "version": version,
                "champion": champion, "reason": "seen on two passes"}

    def test_who_may_not_orders_nothing_and_each_refusal_is_kept(self):
        self.with_accounts()
        version = self.waiting()[0]
        ana, vic, olaf = self.log_in("Ana"), self.log_in("Vic"), self.log_in("Olaf")
        for status, code, arguments in (
                (401, "nobody", {}),
                (403, "token", {**ana, "token": ""}),
                (403, "token", {**ana, "token": vic["token"]}),
                (403, "origin", {**ana, "origin": "http://evil.example"}),
                (403, "role", vic), (403, "role", olaf)):
            got, _, answer = self.post("orders", self.order(version), **arguments)
            self.assertEqual((got, answer["error"]["code"]), (status, code), answer)
        got, _, answer = self.post("orders", self.order(version, champion="77"), **ana)
        self.assertEqual((got, answer["error"]["code"]), (409, "stale"), answer)
        self.assertEqual(self.post("login", {"name": "Ana", "password": "guess"})[0], 403)
        self.assertEqual(self.query("SELECT count(*) FROM command"), [(0,)])
        kept = [json.loads(line)["code"] for line in
                (self.folder / "audit.jsonl").read_text().splitlines()]
        self.assertEqual(kept, ["nobody", "token", "token", "origin", "role", "role", "stale",
                                "login"])
        shown = [one["code"] for one in self.api("refusals")["refusals"]]
        self.assertEqual(shown, kept[::-1])
        got, _, answer = self.post("orders", self.order(None, "hold"), **olaf)
        self.assertEqual((got, answer["ok"]), (200, True), answer)

    def test_double_clicks_and_lost_replies_decide_once(self):
        web = self.with_accounts()
        version = self.waiting()[0]
        ana = self.log_in("Ana")
        order = self.order(version)
        answers = []
        threads = [threading.Thread(target=lambda: answers.append(self.post("orders", order, **ana)))
                   for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        done = [answer for status, _, answer in answers if status == 200]
        self.assertTrue(done)
        self.assertEqual({(one["ok"], one["reply"]) for one in done},
                         {(True, done[0]["reply"])}, answers)
        other = self.waiting()[0]
        order = self.order(other, "reject", champion=version)
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=DEADLINE_S)
        connection.request("POST", "/api/v1/orders", json.dumps(order), {
            "Content-Type": "application/json", "Cookie": ana["cookie"],
            "X-Reident-Token": ana["token"], "Origin": f"http://127.0.0.1:{self.port}"})
        wait_until(lambda: len(self.query("SELECT 1 FROM command")) == 2, "it is carried out")
        web.kill()
        connection.close()
        self.start_web(*self.options, name="again")
        ana = self.log_in("Ana")
        status, _, answer = self.post("orders", order, **ana)
        self.assertEqual((status, answer["ok"]), (200, True), answer)
        self.assertEqual(self.query("SELECT version, kind, actor FROM decision WHERE actor != 'gate' "
                                    "ORDER BY id"),
                         [(int(version), "approve", "Ana"), (int(other), "reject", "Ana")])

    def test_of_two_operators_one_decides_and_the_other_is_told_who_and_when(self):
        self.with_accounts()
        version = self.waiting()[0]
        sessions = {name: self.log_in(name) for name in ("Ana", "Bo")}
        answers = {}

        def decide(name, action):
            answers[name] = self.post("orders", self.order(version, action), **sessions[name])

        threads = [threading.Thread(target=decide, args=pair)
                   for pair in (("Ana", "approve"), ("Bo", "reject"))]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        ((winner, _),) = self.query("SELECT actor, kind FROM decision WHERE actor != 'gate'")
        loser = "Bo" if winner == "Ana" else "Ana"
        status, _, answer = answers[loser]
        text = answer["reply"] if status == 200 else answer["error"]["message"]
        self.assertRegex(text, rf"(by {winner} at|by {winner};)", answers)
        ordered = {one["actor"]: one for one in self.api("commands")["commands"]}
        self.assertEqual((ordered[winner]["ok"], ordered[winner]["version"]), (True, str(version)))
        self.assertFalse(loser in ordered and ordered[loser]["ok"])

    def test_certificates_and_a_trusted_proxy_say_who_it_is(self):
        self.configure([plant.equipment()])
        accounts = self.folder / "accounts.toml"
        accounts.write_text('[[account]]\nname = "Ana"\nrole = "approver"\n')

        def openssl(*arguments):
            subprocess.run(["openssl", *map(str, arguments)], check=True, capture_output=True,
                           cwd=self.folder)

        key = ["-newkey", "rsa:2048", "-nodes", "-keyout"]
        openssl("req", "-x509", *key, "ca.key", "-out", "ca.pem", "-subj", "/CN=authority")
        for name, subject, more in (("server", "localhost", "subjectAltName=DNS:localhost"),
                                    ("ana", "Ana", "subjectAltName=email:ana@example.org")):
            openssl("req", *key, f"{name}.key", "-out", f"{name}.csr", "-subj", f"/CN={subject}")
            (self.folder / f"{name}.ext").write_text(more)
            openssl("x509", "-req", "-in", f"{name}.csr", "-CA", "ca.pem", "-CAkey", "ca.key",
                    "-CAcreateserial", "-extfile", f"{name}.ext", "-out", f"{name}.pem")
        self.start_web("--certificate", self.folder / "server.pem", "--key",
                       self.folder / "server.key", "--client-authority", self.folder / "ca.pem",
                       "--accounts", accounts, name="tls")
        context = ssl.create_default_context(cafile=self.folder / "ca.pem")
        with self.assertRaises((ssl.SSLError, ConnectionError)):
            connection = http.client.HTTPSConnection("localhost", self.port, context=context,
                                                     timeout=DEADLINE_S)
            connection.request("GET", "/api/v1/session")
            connection.getresponse()
        context.load_cert_chain(self.folder / "ana.pem", self.folder / "ana.key")
        connection = http.client.HTTPSConnection("localhost", self.port, context=context,
                                                 timeout=DEADLINE_S)
        connection.request("GET", "/api/v1/session", headers={"X-User": "Bo"})
        answer = connection.getresponse()
        self.assertIn("Strict-Transport-Security", dict(answer.getheaders()))
        session = json.loads(answer.read())
        self.assertEqual((session["user"], session["role"]), ("Ana", "approver"))
        connection.close()

        path = self.folder / "web.sock"
        proxied = self.start("reident-web", "--config", self.folder / "reident.toml", "--socket",
                             path, "--user-header", "X-User", "--accounts", accounts, name="proxied")
        wait_until(lambda: "url=unix:" in proxied.text(), "it serves")
        for user, expected in (("Ana", "Ana"), ("Stranger", None)):
            with socket.socket(socket.AF_UNIX) as connection:
                connection.connect(str(path))
                connection.sendall(b"GET /api/v1/session HTTP/1.1\r\nHost: ops.example\r\n"
                                   b"Connection: close\r\nX-User: " + user.encode() + b"\r\n\r\n")
                got = b""
                while more := connection.recv(1 << 16):
                    got += more
            self.assertEqual(json.loads(got.split(b"\r\n\r\n", 1)[1])["user"], expected)
        self.assertEqual(proxied.terminate()[0], 0)
        self.assertFalse(path.exists())

    def test_metrics_follow_the_registry_and_are_bounded(self):
        self.flown()
        self.start_web()

        def metrics():
            status, headers, body = self.request("/metrics")
            self.assertEqual(status, 200)
            self.assertTrue(headers["Content-Type"].startswith("text/plain; version=0.0.4"))
            return body.decode()

        wait_until(lambda: "reident_service_up 1\n" in metrics(), "the service is heard")
        text = metrics()
        values, typed = {}, set()
        for line in text.splitlines():
            if line.startswith("#"):
                _, word, name, *_ = line.split(" ", 3)
                if word == "TYPE":
                    self.assertNotIn(name, typed, "once")
                    typed.add(name)
                continue
            name, value = line.rsplit(" ", 1)
            self.assertNotIn(name, values, "each series once")
            values[name] = float(value)
            base = re.sub(r"(_bucket|_sum|_count)?(\{.*)?$", "", name)
            self.assertIn(base, typed, line)
        plant_labels = '{spacecraft="SAT",equipment="PLANT"}'
        self.assertEqual(values["reident_champion_version" + plant_labels], self.champion())
        for kind, gate, count in self.query(
                "SELECT kind, actor = 'gate', count(*) FROM decision GROUP BY 1, 2"):
            by = "gate" if gate else "operator"
            self.assertEqual(values[f'reident_decisions_total{{kind="{kind}",by="{by}"}}'], count)
        self.assertLessEqual(len([one for one in values if 'equipment="PLANT"' in one]), 40)
        self.request("/nothing-that-exists")
        self.assertNotIn("nothing-that-exists", metrics())

    def test_another_user_with_read_rights_alone_sees_all_also_of_a_service_that_stopped(self):
        if os.getuid() != 0:
            self.skipTest("only root can run a program as another user")
        daemon = self.flown()
        self.folder.chmod(0o755)
        for file in self.folder.iterdir():
            file.chmod(file.stat().st_mode | 0o044)
        nobody = pwd.getpwnam("nobody").pw_uid
        web = self.start_web(user=nobody)
        champion = str(self.champion())
        self.assertEqual(self.api("overview")["equipment"][0]["champion"], champion)
        self.assertEqual(daemon.terminate()[0], 0)
        self.assertEqual(self.api("overview")["equipment"][0]["champion"], champion)
        self.assertTrue(self.api("telemetry", spacecraft="SAT", parameter="out")["least"])
        self.assertTrue(web.running())

    def test_killed_again_and_again_it_loses_no_frame(self):
        self.configure([plant.equipment()])
        self.start_daemon()
        csv = plant.write(self.folder / "all.csv", plant.rows(count=4000))
        replay = self.replay(csv, "--speed", "1000", "--wait-readers", 1)
        kills = 0
        while replay.running():
            web = self.start_web(name=f"web-{kills}")
            self.request("/api/v1/overview")
            self.request("/api/v1/telemetry?spacecraft=SAT&parameter=out")
            web.signal(signal.SIGKILL)
            web.wait()
            kills += 1
        self.assertEqual(replay.wait(), 0, replay.text())
        self.wait_idle()
        self.assertGreater(kills, 0)
        self.assertEqual(self.stored(), 3 * 4000)
        connection = sqlite3.connect(self.database)
        self.assertEqual(connection.execute("PRAGMA integrity_check").fetchone(), ("ok",))
        connection.close()


if __name__ == "__main__":
    sys.exit(unittest.main())
