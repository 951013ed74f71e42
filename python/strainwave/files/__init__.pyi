from .entries import Entry as Entry, Quantity as Quantity
from .ratings import RatingCheck as RatingCheck, RatingWarning as RatingWarning
