from .entries import Entry as Entry, Quantity as Quantity
from .mesh_table import MeshTable as MeshTable, ModeTable as ModeTable
from .ratings import RatingCheck as RatingCheck, RatingWarning as RatingWarning
