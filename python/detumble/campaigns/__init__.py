"""Campaigns: many flights of one dispersed scenario, their storage, statistics and distribution over workers."""
