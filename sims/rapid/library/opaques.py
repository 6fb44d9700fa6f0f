"""Types that RAPID cannot look into and whose instructions belong to others, or to nobody here.

Data of them can be declared; who offers an instruction for one registers it again with a value.
"""

from sims.rapid.builtin import OPAQUE, opaque

__all__: list[str] = []

_NAMES = """
    cameradev cameratarget clock corrdescr datapos dir egmident iodev
    loadsession mecunit pathrecid rawbytes rmqmessage rmqslot shapedata
    socketdev syncident taskid trapdata triggdata wzstationary
    wztemporary
"""

for _name in _NAMES.split():
    if _name not in OPAQUE:
        opaque(_name)
