"""The peers' implementations (`run_*.py`, one a peer, each a process of its own), and what runs, checks and measures them."""
