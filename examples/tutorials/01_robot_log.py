# %% [markdown]
# # A robot's log to a gear in ten minutes
#
# A page in the making.

# %%
import matplotlib.pyplot as plt

plt.plot([1.0, 2.0])
_ = plt.title("a line")
