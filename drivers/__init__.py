"""Devices that are there: codec, transport and device, one folder a family."""

from hal.registry import Backend, Scheme

__all__ = ["BACKENDS", "SCHEMES", "SUITES"]

BACKENDS: dict[str, Backend] = {}
SCHEMES: dict[str, Scheme] = {}
SUITES: dict[str, str] = {}
