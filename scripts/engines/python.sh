# Interpreters and packages of the engines in Python; to be sourced. `installed` is the folder of all environments.

# Prints the first interpreter of at least this version, or fails.
python_of() { # 3.N
    for python in "python$1" "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$1".*/bin/python python3; do
        if "$python" -c "import sys; sys.exit(sys.version_info[:2] $2 tuple(map(int, '$1'.split('.'))))" 2>/dev/null; then
            echo "$python"
            return
        fi
    done
    return 1
}

# Makes the environment NAME with the packages of FILE. A stamp names what it holds.
install_python() { # name, requirements, python
    stamp=$installed/$1/requirements.txt
    if ! cmp -s "$2" "$stamp"; then
        "$3" -m venv "$installed/$1"
        "$installed/$1/bin/python" -m pip install -q --disable-pip-version-check -r "$2" || return 1
        cp "$2" "$stamp"
    fi
}
