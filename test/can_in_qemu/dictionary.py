"""Object dictionary of the simulated drives' table as the canopen library wants it."""
import canopen
import yaml
from canopen import objectdictionary as od

TYPES = {"u8": od.UNSIGNED8, "u16": od.UNSIGNED16, "u32": od.UNSIGNED32, "i8": od.INTEGER8, "i16": od.INTEGER16,
         "i32": od.INTEGER32}


def load(path):
    dictionary = canopen.ObjectDictionary()
    with open(path) as file:
        entries = yaml.safe_load(file)["objects"]
    subindices = {}
    for entry in entries:
        index, subindex = (int(part, 16) for part in entry["object"].split(":"))
        variable = od.ODVariable(f"{index:04X}:{subindex:02X}", index, subindex)
        variable.data_type = TYPES[entry["type"]]
        variable.access_type = entry.get("access", "ro")
        variable.default = int(entry.get("value", 0))
        subindices.setdefault(index, []).append(variable)
    for index, variables in subindices.items():
        if len(variables) == 1 and variables[0].subindex == 0:
            dictionary.add_object(variables[0])
            continue
        record = od.ODRecord(f"{index:04X}", index)
        for variable in variables:
            record.add_member(variable)
        dictionary.add_object(record)
    return dictionary
