"""Sweet Home 3D files by their published format: archives with Home.xml and models."""

from __future__ import annotations

import zipfile
from collections.abc import Mapping
from pathlib import Path

__all__ = ["CUBE", "FLAT", "write_home"]

CUBE = b"""# a cube of one unit, named as the program names what it knows
o cube
v -0.5 0 -0.5
v 0.5 0 -0.5
v 0.5 0 0.5
v -0.5 0 0.5
v -0.5 1 -0.5
v 0.5 1 -0.5
v 0.5 1 0.5
v -0.5 1 0.5
usemtl redwood
f 1 2 3 4
f 8 7 6 5
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
"""

FLAT = """<?xml version='1.0'?>
<home version='7000' name='flat.sh3d' wallHeight='250.0'>
  <observerCamera attribute='observerCamera' x='300' y='360' z='160' yaw='3.1415927'
                  pitch='0.1' fieldOfView='1.1'/>
  <camera attribute='topCamera' x='0' y='0' z='900' yaw='0' pitch='0.8' fieldOfView='1.1'/>
  <camera attribute='storedCamera' name='To the north' x='100' y='300' z='150' yaw='3.1415927'
          pitch='0' fieldOfView='1.5707963'/>
  <doorOrWindow id='d' name='Door' model='0' x='300' y='200' angle='1.5707964' width='90'
                depth='12' height='210'/>
  <doorOrWindow id='w' name='Window' model='0' x='100' y='0' elevation='90' width='100' depth='30'
                height='120'/>
  <pieceOfFurniture id='p' catalogId='Lib#chair' name='Chair' model='0' x='150' y='150'
                    angle='0.5' width='50' depth='40' height='90' creator='somebody'
                    license='CC0'/>
  <pieceOfFurniture id='q' name='Box' model='0' x='450' y='100' width='60' depth='30' height='40'
                    color='FF3366CC'/>
  <pieceOfFurniture id='h' name='Hidden' model='0' x='450' y='300' width='60' depth='30'
                    height='40' visible='false'/>
  <furnitureGroup id='g' name='Group' x='500' y='350' width='40' depth='40' height='20'>
    <light id='l' name='Lamp' model='0' x='500' y='350' width='20' depth='20' height='50'
           power='0.8'>
      <lightSource x='0.5' y='0.5' z='1.2' color='00FFC080'/>
    </light>
  </furnitureGroup>
  <wall id='s' wallAtStart='w2' wallAtEnd='e' xStart='0' yStart='400' xEnd='600' yEnd='400'
        height='250' thickness='20' leftSideColor='00E8E0D0' rightSideColor='00C86432'/>
  <wall id='e' wallAtStart='s' wallAtEnd='n' xStart='600' yStart='400' xEnd='600' yEnd='0'
        height='250' thickness='20'/>
  <wall id='n' wallAtStart='e' wallAtEnd='w2' xStart='600' yStart='0' xEnd='0' yEnd='0'
        height='250' thickness='20'/>
  <wall id='w2' wallAtStart='n' wallAtEnd='s' xStart='0' yStart='0' xEnd='0' yEnd='400'
        height='250' thickness='20'/>
  <wall id='m' xStart='300' yStart='10' xEnd='300' yEnd='390' height='250' thickness='10'/>
  <room name='West' floorColor='00A07850'>
    <point x='10' y='10'/><point x='295' y='10'/><point x='295' y='390'/><point x='10' y='390'/>
  </room>
  <room name='East' ceilingVisible='false'>
    <point x='305' y='10'/><point x='590' y='10'/><point x='590' y='390'/><point x='305' y='390'/>
  </room>
</home>
"""
"""Two rooms of 3 × 4 m with a door between them, a window to the north and some furniture."""


def write_home(
    path: Path, xml: str | bytes = FLAT, files: Mapping[str, bytes] | None = None
) -> Path:
    """Write an archive with Home.xml and other files, ``0`` a cube unless told otherwise."""
    data = xml.encode() if isinstance(xml, str) else xml
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("Home.xml", data)
        for name, content in ({"0": CUBE} if files is None else files).items():
            archive.writestr(name, content)
    return path
