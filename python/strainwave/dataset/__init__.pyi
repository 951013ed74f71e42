from .faults import with_faults as with_faults
