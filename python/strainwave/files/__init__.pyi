from .entries import Entry as Entry
from .entries import Quantity as Quantity
from .ratings import RatingCheck as RatingCheck
from .ratings import RatingWarning as RatingWarning
