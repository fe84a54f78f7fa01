"""From logs to parameters with honest errors."""

from softid.identification.model_selection import ModelChoice, choose_model
from softid.identification.parameter_bootstrap import bootstrap_parameters
from softid.identification.profile_likelihood import profile_parameter
from softid.identification.workflow import fit

__all__ = ["ModelChoice", "bootstrap_parameters", "choose_model", "fit", "profile_parameter"]
