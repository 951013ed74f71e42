# %% [markdown]
# # Fault data and a detector
#
# At the end you have labelled data of healthy and faulty joints, and a detector judged on units that it was not trained on.
# You compare it with the own past of each unit, and see how a wrong split makes a useless detector look good.
#
# **Time:** 20 minutes. **You need:** strainwave with matplotlib, pandas and scikit-learn (`pip install pandas scikit-learn`).

# %% [markdown]
# ## The plan
#
# A plan describes units, faults and conditions. Here 60 actuators differ in friction, stiffness and the eccentricity of
# their wave generator. Each is recorded new and after a million output revolutions, under four conditions of speed,
# temperature and load. In half of the units a misalignment grows meanwhile.

# %%
import json
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import strainwave as sw
from sklearn.ensemble import ExtraTreesClassifier
from sklearn.linear_model import LogisticRegression
from sklearn.metrics import roc_auc_score, roc_curve
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import StandardScaler
from strainwave.dataset.make import make
from strainwave.diagnose.baseline import baseline_of, compared
from strainwave.diagnose.refusals import usable
from strainwave.diagnose.replicates import joint_motion

print(Path("09_fault_data_plan.toml").read_text())

# %%
made = make("09_fault_data_plan.toml", "data", workers=1)
print(*sorted(path.name for path in made.iterdir()), sep="\n")

# %% [markdown]
# On the command line: `strainwave dataset make 09_fault_data_plan.toml --out data`. `strainwave dataset estimate` measures what
# a plan takes. `data/card.md` describes the set, `data/manifest.json` each column.
#
# ## Look at the rows
#
# Each row is a recording: labels, conditions, and features of its signals. The manifest gives the role of each column. Only a
# *feature* may go into a detector. A *parameter* is a number of the simulated drive, which no sensor of a real joint shows.

# %%
runs = pd.read_parquet("data/shards").sort_values("member", ignore_index=True)
roles = pd.DataFrame(json.loads(Path("data/manifest.json").read_text())["columns"]).groupby("role")["name"].apply(list)
print(len(runs), "rows;", ", ".join(f"{len(names)} {role}" for role, names in roles.items()))
print(runs.groupby(["fault", "stage"])["severity.misalignment"].agg(["count", "min", "max"]).round(2))

# %% [markdown]
# Read this table before you train. The column `fault` names the fault that a unit *will* get; at stage 0 its severity is 0.
# The label of a recording is therefore the severity, not `fault`.

# %%
faulty = (runs["severity.misalignment"] > 0.0).to_numpy()
late = (runs["stage"] == 1).to_numpy()
figure, panels = plt.subplots(1, 2, figsize=(9.0, 3.5), layout="constrained")
for axes, name in zip(panels, ("current_rms", "current_order_2_forward"), strict=True):
    bins = np.linspace(runs[name].min(), runs[name].max(), 25)
    axes.hist(runs[name][~faulty], bins, alpha=0.6, density=True, label="healthy")
    axes.hist(runs[name][faulty], bins, alpha=0.6, density=True, label="misaligned")
    axes.set(xlabel=f"{name} [A]", ylabel="density")
panels[0].set_title("The rms of the current does not separate them")
panels[1].set_title("Order 2 does in part")
panels[1].legend()

# %% [markdown]
# ## A detector, judged on units that it never saw
#
# `split_unit` puts all rows of a unit on one side. The detector is a logistic regression on the features of current and
# speed, which a real joint measures. Features that are not a number in some rows are left out, because the actuator turns
# in one direction only. ROC curves compare the detector with single features.

# %%
features = [name for name in roles["feature"] if name.startswith(("current", "input_speed")) and runs[name].notna().all()]
train = (runs["split_unit"] == "train").to_numpy()
both = set(runs["unit"][train]) & set(runs["unit"][~train])
print(f"{runs['unit'][train].nunique()} units to train, {runs['unit'][~train].nunique()} to test, {len(both)} in both")

detector = make_pipeline(StandardScaler(), LogisticRegression(max_iter=1000)).fit(runs[features][train], faulty[train])
tested = ~train & late
scores = {
    "detector": detector.predict_proba(runs[features])[:, 1],
    "order 2 of the current": runs["current_order_2_forward"].to_numpy(),
    "rms of the current": runs["current_rms"].to_numpy(),
}

# %% [markdown]
# ## Compare with the own past
#
# A healthy recording of the *same* unit is worth more than many of others. The simplest use: the ratio of order 2 late to
# new, under the same condition.

# %%
new = runs[~late].set_index(["unit", "condition"])["current_order_2_forward"]
own_past = new.reindex(pd.MultiIndex.from_frame(runs[["unit", "condition"]])).to_numpy()
scores["order 2 over its own past"] = runs["current_order_2_forward"].to_numpy() / own_past

figure, axes = plt.subplots(figsize=(6.0, 5.0), layout="constrained")
for name, score in scores.items():
    area = roc_auc_score(faulty[tested], score[tested])
    print(f"{name:30} area under the ROC curve {area:.2f}")
    axes.plot(*roc_curve(faulty[tested], score[tested])[:2], label=f"{name}: {area:.2f}")
axes.plot([0.0, 1.0], [0.0, 1.0], "--", color="gray", label="chance: 0.50")
axes.set(xlabel="share of healthy recordings with an alarm", ylabel="share of misaligned recordings with an alarm")
axes.set_title("ROC on late recordings of units not in the training")
axes.legend(loc="lower right")

# %% [markdown]
# The detector gains little over the one feature that physics names, order 2. The own baseline removes what differs between
# units, and gains most.
#
# `strainwave diagnose joint` makes this comparison with statistics: each order against the baseline recordings of the joint, at
# a stated rate of false alarms. Its functions run here on the recorded signals of ten test units.

# %%
signals = pd.read_parquet("data/samples").set_index("member")


def motion(member):
    """Return the prepared recording of a member, without its first 0.2 s."""
    columns = {name: np.array(signals[name][member])[100:] for name in ("input_angle", "current")}
    columns["time"] = 2e-3 * np.arange(len(columns["current"]))
    return joint_motion(
        usable(sw.Recording(columns, {"time": "s", "input_angle": "rad", "current": "A"}), "record", ratio=100.0)
    )


counts = {True: [0, 0], False: [0, 0]}  # faulty or not: alarms, recordings
for unit in runs["unit"][~train].unique()[:10]:
    own = runs[runs["unit"] == unit]
    baseline = baseline_of([motion(member) for member in own["member"][own["stage"] == 0]], [2.0, 4.0])
    for row in own[own["stage"] == 1].itertuples():
        count = counts[bool(faulty[row.Index])]
        count[0] += bool(compared(baseline, motion(row.member)).alarms)
        count[1] += 1
print("misaligned: {} alarms in {} recordings".format(*counts[True]))
print("healthy:    {} alarms in {} recordings".format(*counts[False]))

# %% [markdown]
# ## How a wrong split lies
#
# Now give each unit a random label, which no detector can learn. Train a forest with rows split at random, and the same
# forest with units split. The mean is over six draws of the labels.

# %%
complete = [name for name in roles["feature"] if runs[name].notna().all()]
areas = {"rows split at random": [], "units split": []}
for seed in range(6):
    chance = np.random.default_rng(seed)
    lot = chance.permutation(runs["unit"].nunique()) % 2 == 0
    label = lot[runs["unit"]]
    for name, used in (("rows split at random", chance.random(len(runs)) < 0.6), ("units split", train)):
        forest = ExtraTreesClassifier(100, random_state=0).fit(runs[complete][used], label[used])
        areas[name].append(roc_auc_score(label[~used], forest.predict_proba(runs[complete][~used])[:, 1]))
for name, values in areas.items():
    print(f"{name:22} area under the ROC curve {np.mean(values):.2f}, from {min(values):.2f} to {max(values):.2f}")

# %% [markdown]
# With rows split at random, the forest recognises *units*, which differ in friction and eccentricity. The same happens with
# real data if one joint is in training and test, and the number looks good until the next joint comes.
#
# ## What can mislead
#
# | trap | what to do |
# |---|---|
# | one unit in training and test | Split by `split_unit`. Split by `split_condition` too if new motions will come. |
# | a parameter as a feature | Take columns with the role *feature* only. |
# | the label `fault` at an early stage | Use `severity.…`, which is 0 before the onset. |
# | many rows, few units | Count units, not rows. The units split above scatters far, because it tests 24 units. |
# | a detector of simulated data on a real joint | A model lacks effects. Choose features here, and thresholds on real joints. |
#
# ## Where to go on
#
# * [Data sets for learning](../../docs/how-to/datasets.md): plans, splits, many machines.
# * [Diagnose a gear from its motor current](../../docs/how-to/diagnose.md): the comparison with a baseline on your recordings.
# * [Detection probability of a diagnosis](../../docs/validation/detection-benchmark.md): three faults over their severity.
