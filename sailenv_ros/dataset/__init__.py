"""Data sets by recipe: what is seen how often, written by any number of machines, read again."""

from sailenv_ros.dataset.dataset_reader import Dataset, DatasetFrame, open_dataset
from sailenv_ros.dataset.dataset_reader import open_dataset as open
from sailenv_ros.dataset.engine_choice import engine_of
from sailenv_ros.dataset.job import Job, RecipeError, load_job, load_recipe
from sailenv_ros.dataset.making import MadeDataset, Progress, make_dataset
from sailenv_ros.dataset.verifying import Difference, verify_dataset

__all__ = [
    "Dataset",
    "DatasetFrame",
    "Difference",
    "Job",
    "MadeDataset",
    "Progress",
    "RecipeError",
    "engine_of",
    "load_job",
    "load_recipe",
    "make_dataset",
    "open",
    "open_dataset",
    "verify_dataset",
]
