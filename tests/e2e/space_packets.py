"""CCSDS space packets of the power subsystem in deploy/eps-xtce.xml."""

import struct

TAI_1958 = 378_691_200  # seconds from 1958 to 1970
LEAP_SECONDS = 37       # TAI - UTC since 2017
APID = 100


def packet(count, data, apid=APID, version=0, grouping=3):
    """`data` is what stands behind the primary header."""
    return struct.pack(">HHH", version << 13 | 0x0800 | apid, grouping << 14 | count % 16384,
                       len(data) - 1) + data


def cuc(seconds):
    """Time as 4 bytes of TAI seconds since 1958 and 2 of their fraction, from seconds of 1970 UTC in
    steps of 1/65536."""
    ticks = round((seconds + TAI_1958 + LEAP_SECONDS) * 65536)
    return struct.pack(">IH", ticks >> 16, ticks & 0xffff)


def bdr(count, seconds, raw_in1, raw_in2, raw_out):
    """Currents (raw - 128) / 128, the same, and raw / 1024."""
    return packet(count, cuc(seconds) + b"\x01" + (raw_in1 << 12 | raw_in2).to_bytes(3, "big") +
                  struct.pack(">h", raw_out))


def battery(count, seconds, raw_voltage, current, raw_array, mode, heater):
    return packet(count, cuc(seconds) + b"\x02" + struct.pack(">Hf", raw_voltage, current) +
                  struct.pack("<H", raw_array) + bytes([mode << 6 | heater]))


def mea(count, seconds, raw_sg2, bus_current, bus_voltage, raw_voltage, name=b"MEA-MAIN"):
    data = cuc(seconds) + b"\x03" + name + struct.pack(">hfd", raw_sg2, bus_current, bus_voltage)
    return packet(count, data + (struct.pack(">H", raw_voltage) if name == b"MEA-MAIN" else b""))
