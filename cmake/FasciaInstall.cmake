# filled in by the install step: every module, headers, and a package config
