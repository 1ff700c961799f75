"""What the paper prints, to hold ourselves against: Eng. Proc. 2026, 121(1), 25."""

PUBLISHED_CAPTURE_TIMES = {"pd": 104.4, "lqr": 24.6, "sosmc": 28.1, "tsmc": 51.2, "prrl": 7.6}
"""Capture time of each law, s."""
