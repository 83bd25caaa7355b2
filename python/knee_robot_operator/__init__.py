"""The operator's page: a web server beside the controller (docs/operator.md). No part of the safety chain."""
