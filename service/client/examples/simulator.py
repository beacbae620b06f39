"""Runs the approved model of a battery discharge regulator on made-up currents, once a second.

simulator.py [STEPS [DOMAIN [PARTITION]]]
"""

import sys
import time

import reident


def main(steps="60", domain="0", partition="operations"):
    with reident.Client(domain=int(domain), partition=partition, spacecraft="CBERS-4",
                        equipment=["BDR"]) as client:
        bdr = client.runner("CBERS-4", "BDR", inputs={"I_BDRIN1": "A", "I_BDRIN2": "A"},
                            outputs={"I_BDROUT": "A"})
        for k in range(int(steps)):
            y, flags = bdr.step([1 + 0.01 * (k % 50), 0.5])
            for event in client.events():
                print(f"{event.equipment}: {event.text}")
            if reident.Flags.NO_MODEL in flags:
                print(f"step {k}: no model yet")
            else:
                print(f"step {k}: version {bdr.state().version}, I_BDROUT {y[0]:.4f} A")
            time.sleep(1)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except reident.ClientError as error:
        sys.exit(str(error))
