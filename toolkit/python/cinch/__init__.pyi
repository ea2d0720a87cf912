# SPDX-License-Identifier: Apache-2.0
from cinch._core import *
from cinch._core import __version__ as __version__
