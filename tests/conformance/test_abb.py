"""The ABB driver, with the shipped RAPID modules executed behind an in-memory wire."""

from sims.controller.suites import TestRapidIo, TestRapidRobot

__all__ = ["TestRapidIo", "TestRapidRobot"]
