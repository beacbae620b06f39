"""Space packets, by an XTCE database, become telemetry in SQLite."""

import json
import socket
import struct
import subprocess
import sys
import unittest
from pathlib import Path

import plant
from harness import BIN, EndToEnd, wait_until
from space_packets import APID, battery, bdr, cuc, mea, packet

NS = 1_000_000_000
BEGIN_S = 1_700_000_000
DATABASE = Path(__file__).parents[2] / "deploy" / "eps-xtce.xml"
TIME = ["--time", "cuc:4.2"]


def spline(raw):
    """The calibration of V_BAT1 and V_MEA."""
    return raw / 512 if raw <= 16384 else 32 + (raw - 16384) * 16 / 49152


def single(value):
    """As it comes out of 32 bits."""
    return struct.unpack(">f", struct.pack(">f", value))[0]


def round_of(k):
    """The packets of half a second, and {(parameter, time): value} of them."""
    seconds = BEGIN_S + k / 2
    at = BEGIN_S * NS + k * NS // 2
    in1, in2, out = k % 4096, (7 * k) % 4096, (k * 37) % 65536 - 32768
    voltage, array, sg2 = (k * 211) % 65536, (k * 97) % 65536, 1000 - k
    packets = [bdr(3 * k, seconds, in1, in2, out),
               battery(3 * k + 1, seconds, voltage, 0.1 * k, array, k % 3, k % 2),
               mea(3 * k + 2, seconds, sg2, -0.3 * k, 28 + k / 1000, voltage)]
    values = {"I_BDRIN1": (in1 - 128) / 128, "I_BDRIN2": (in2 - 128) / 128, "I_BDROUT": out / 1024,
              "V_BAT1": spline(voltage), "I_BAT1": single(0.1 * k), "I_SAG1A": array / 1024,
              "BAT1_MODE": k % 3, "BAT1_HEATER": k % 2, "I_SG2": sg2 / 1024,
              "I_BUS": single(-0.3 * k), "V_BUS": 28 + k / 1000, "V_MEA": spline(voltage)}
    return packets, {(name, at): value for name, value in values.items()}


def stream_of(rounds):
    packets, values = [], {}
    for k in range(rounds):
        more, of_them = round_of(k)
        packets += more
        values.update(of_them)
    return packets, values


class Gateway(EndToEnd):
    def start_service(self):
        self.configure([plant.equipment(window="1h", slide="1h")], spacecraft="SAT-1")
        return self.start_daemon()

    def gateway(self, *arguments):
        return self.start("satcs-gateway", DATABASE, *arguments, "--spacecraft", "SAT-1", *TIME,
                          "--json", *self.endpoint())

    def published(self, packets):
        """The summary of the gateway, of a file with these bytes."""
        path = self.folder / "packets.bin"
        path.write_bytes(b"".join(packets))
        gateway = self.gateway(path, "--speed", "max")
        self.assertEqual(gateway.wait(), 0, gateway.text())
        return json.loads(gateway.out.read_text())

    def values(self):
        return {key: value for key, (value, _) in self.samples().items()}

    def assert_archived(self, expected):
        """Names what differs: two lists of thousands of values say nothing."""
        found = self.values()
        self.assertEqual({key: (found.get(key), expected.get(key))
                          for key in found.keys() | expected.keys()
                          if found.get(key) != expected.get(key)}, {})

    def check(self, *arguments):
        done = subprocess.run([str(BIN / "satcs-gateway"), *map(str, arguments)], text=True,
                              capture_output=True, timeout=60, check=False)
        return done.returncode, done.stdout, done.stderr

    def test_every_value_of_the_packets_of_a_file_is_archived(self):
        packets, expected = stream_of(600)
        self.start_service()
        summary = self.published(packets)
        self.assertEqual((summary["outcome"], summary["frames"]), ("complete", 1800))
        self.assertEqual(summary["packets"]["left_out"], [])
        self.assertEqual(self.wait_idle()["sequence_missing"], 0)
        self.assert_archived(expected)
        self.assertEqual(self.query(
            "SELECT unit, kind, low_limit, high_limit, description FROM parameter "
            "WHERE name = 'V_BUS'"), [("V", "analog", 26.0, 30.0, "Main bus voltage")])
        (kind, description), = self.query(
            "SELECT kind, description FROM parameter WHERE name = 'BAT1_MODE'")
        self.assertEqual(kind, "digital")
        self.assertIn("OFF=0, CHARGE=1, DISCHARGE=2", description)

    def test_values_are_flagged_as_the_database_says(self):
        self.start_service()
        self.published([mea(0, BEGIN_S, 0, 0, 30, 0), mea(1, BEGIN_S + 1, 0, 0, 30.1, 0),
                        mea(2, BEGIN_S + 2, 0, 0, float("nan"), 0),
                        mea(3, BEGIN_S + 3, 0, 0, 28, 0, name=b"MEA-REDU"),
                        battery(4, BEGIN_S + 4, 0, 0, 0, 3, 0)])
        self.wait_idle()
        samples = self.samples()
        bus = [samples["V_BUS", (BEGIN_S + k) * NS][1] for k in range(3)]
        self.assertEqual(bus, ["good", "out of limits", "invalid"])
        self.assertNotIn(("V_MEA", (BEGIN_S + 3) * NS), samples, "its condition does not hold")
        self.assertEqual(samples["BAT1_MODE", (BEGIN_S + 4) * NS], (3.0, "suspect"))

    def test_what_is_missing_or_wrong_is_counted_with_its_place(self):
        packets, expected = stream_of(100)
        for k, name in ((10, "BDR"), (11, "BAT1"), (12, "MEA")):  # 30, 34, 38: these do not come
            lost = 3 * k + k - 10
            packets[lost] = b""
            at = BEGIN_S * NS + k * NS // 2
            gone = {"BDR": ("I_BDRIN1", "I_BDRIN2", "I_BDROUT"),
                    "BAT1": ("V_BAT1", "I_BAT1", "I_SAG1A", "BAT1_MODE", "BAT1_HEATER"),
                    "MEA": ("I_SG2", "I_BUS", "V_BUS", "V_MEA")}[name]
            for parameter in gone:
                del expected[parameter, at]
        at = [sum(map(len, packets[:index])) for index in range(301)]
        time = cuc(BEGIN_S)
        wrong = {"no_header": b"\xff" * 9, "no_container": packet(0, time + b"\x09", apid=101),
                 "too_short": packet(300, time + b"\x01\x00"),
                 "segment": packet(301, time + b"\x01" + b"\x00" * 5, grouping=1),
                 "time_range": packet(302, b"\x00" * 6 + b"\x01" + b"\x00" * 5),
                 "idle": packet(0, b"\x00" * 20, apid=0x7ff), "cut": packet(303, time)[:-1]}
        offset = at[300]
        self.start_service()
        summary = self.published(packets + list(wrong.values()))
        left_out = {one["reason"]: one for one in summary["packets"]["left_out"]}
        self.assertEqual(sorted(left_out), sorted(set(wrong) - {"idle"}))
        for reason, data in wrong.items():
            if reason != "idle":
                self.assertEqual((left_out[reason]["count"], left_out[reason]["first_offset"]),
                                 (1, offset), reason)
            offset += len(data)
        self.assertIn("I_BDRIN1", left_out["too_short"]["first"])
        apid = next(one for one in summary["packets"]["apids"] if one["apid"] == APID)
        self.assertEqual((apid["packets"], apid["missing"]), (300, 3))
        self.assertEqual(self.wait_idle()["sequence_missing"], 3)
        self.assert_archived(expected)

    def test_a_port_takes_packets_until_the_gateway_is_stopped(self):
        packets, expected = stream_of(60)
        for kind in "udp", "tcp":
            with self.subTest(kind):
                with socket.socket() as free:
                    free.bind(("127.0.0.1", 0))
                    port = free.getsockname()[1]
                service = self.start_service()
                gateway = self.gateway(f"--{kind}", port)
                self.send(kind, port, packets)
                wait_until(lambda: self.stored() == 60 * 12, "every packet is archived")
                self.assertEqual(gateway.terminate()[0], 0, gateway.text())
                self.assertEqual(json.loads(gateway.out.read_text())["frames"], 180)
                self.assert_archived(expected)
                service.terminate()
                self.database.unlink()

    def send(self, kind, port, packets):
        """In datagrams of three packets, or cut anywhere."""
        if kind == "udp":
            wait_until(lambda: f"{port:04X}" in Path("/proc/net/udp").read_text(), "the port is open")
            with socket.socket(type=socket.SOCK_DGRAM) as sender:
                for k in range(0, len(packets), 3):
                    sender.sendto(b"".join(packets[k:k + 3]), ("127.0.0.1", port))
            return

        def connected():
            try:
                return socket.create_connection(("127.0.0.1", port), timeout=10)
            except ConnectionRefusedError:
                return None
        data = b"".join(packets)
        for part in data[:len(packets[0])], data[len(packets[0]):]:  # two connections
            with wait_until(connected, "the port is open") as sender:
                for k in range(0, len(part), 41):
                    sender.sendall(part[k:k + 41])

    def test_standard_input_is_a_source_too(self):
        packets, expected = stream_of(20)
        self.start_service()
        done = subprocess.run(
            [str(BIN / "satcs-gateway"), str(DATABASE), "-", "--spacecraft", "SAT-1", *TIME,
             "--speed", "max", *map(str, self.endpoint())], input=b"".join(packets),
            capture_output=True, timeout=60, check=False)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.wait_idle()
        self.assert_archived(expected)

    def test_a_model_is_identified_from_packets(self):
        self.configure([plant.equipment(inputs=["I_BAT1", "I_BUS"], outputs=["V_BUS"])],
                       spacecraft="SAT-1")
        self.start_daemon()
        packets = []
        for k, (at, drive, load, out) in enumerate(plant.rows(1300)):
            packets += [battery(2 * k, at, 0, drive, 0, 0, 0), mea(2 * k + 1, at, 0, load, out, 0)]
        self.published(packets)
        self.wait_idle()
        outcomes = [outcome for outcome, in self.query("SELECT outcome FROM attempt")]
        self.assertIn("challenger", outcomes)

    def test_a_check_shows_what_database_and_packets_yield(self):
        packets, _ = stream_of(10)
        path = self.folder / "packets.bin"
        path.write_bytes(b"".join(packets[:-1]))
        status, out, _ = self.check(DATABASE, path, *TIME, "--check")
        self.assertEqual(status, 0)
        self.assertIn("29 frames", out)
        self.assertIn(f"APID {APID}: 29 packets", out)
        status, out, _ = self.check(DATABASE, "--list", "--only", "V_BUS")
        self.assertEqual(status, 0)
        self.assertIn("26..30", out)

    def test_what_is_not_known_is_named_and_refused_on_request(self):
        path = self.folder / "unknown.xml"
        path.write_text(DATABASE.read_text().replace(
            '<FloatDataEncoding sizeInBits="64"/>', '<FloatDataEncoding sizeInBits="128"/>'))
        line = 1 + path.read_text().split('sizeInBits="128"')[0].count("\n")
        status, out, errors = self.check(path, "--list")
        self.assertEqual(status, 0)
        self.assertIn(f"line {line}: ", errors)
        self.assertIn("FloatParameterType[BusVoltage]/FloatDataEncoding", errors)
        self.assertIn("V_BUS", out.split("not published")[-2] + out.split("not published")[-1])
        self.assertEqual(self.check(path, "--list", "--strict")[0], 2)

    def test_impossible_requests_are_refused(self):
        path = self.folder / "packets.bin"
        path.write_bytes(b"")
        for arguments in ([], [path], [path, "--udp", 10015, *TIME], [path, "--time", "cuc:9.9"],
                          [path, *TIME, "--only", "V_BUSS"], [path, *TIME, "--leap-seconds"]):
            status, _, errors = self.check(DATABASE, "--spacecraft", "SAT-1", *arguments)
            self.assertEqual(status, 2, errors)
            self.assertIn("satcs-gateway: ", errors)
        self.assertEqual(self.check(DATABASE, path, *TIME)[0], 2, "without --spacecraft")
        self.assertEqual(self.check(self.folder / "none.xml", "--list")[0], 2)


if __name__ == "__main__":
    sys.exit(unittest.main())
