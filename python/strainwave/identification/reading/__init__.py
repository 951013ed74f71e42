"""Files of measurements: which columns they have, and what each seems to be. `recognise` reads one in this order:

source         the file, opened once; recordings in several files, several recordings in one
times          one column of time; then the clock of the rows, with jitter, gaps and restarts
names          quantity, side and joint in the name of a column or file; the channels
unnamed        columns without names: their layout by the numbers
mapping        what a person states: columns, units, signs, constants
columns        one column for each channel
values, units  their values in SI units: units that are stated, given or shown by the numbers
roles          the column of each channel, and its side
motion         angles that begin anew, jump or are held; slopes
joints         the joints that move
answers        the question that is left open, with the answers that work
several_files  files of one recorder in one reading, joined, and each counted once
"""
