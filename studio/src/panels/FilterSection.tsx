// How neighbouring cells of different levels are made to fit, looked at before it is applied.
import { useEffect, useState } from "react";
import { foresee, forget } from "../document/previews";
import { ask } from "../document/store";
import { Choice, Section } from "./parts";
import { useStudio } from "./use";

const METHODS = [
  {
    value: "recursive",
    name: "Recursive (QrT)",
    explains: "Neighbours differ by one level at most: the filter subdivides cells until they do.",
  },
  {
    value: "extensible",
    name: "Extensible (QeT)",
    explains: "Cells of any levels meet; types are chosen so that nodes on edges are tied.",
  },
  {
    value: "dynamic",
    name: "Dynamic (QdT)",
    explains: "Cells of any levels meet; those of type 6 dynamic tie to every node around them.",
  },
];

export function FilterSection() {
  const method = useStudio((state) => state.document!.method);
  return <Method key={method} method={method} />;
}

function Method({ method }: { method: string }) {
  const [chosen, setChosen] = useState(method);
  const told = METHODS.find(({ value }) => value === chosen)!;
  const other = chosen !== method;
  useEffect(() => {
    if (!other) return;
    foresee(`the ${told.name} filter`, request(chosen), 0);
    return forget;
  }, [chosen, other, told.name]);
  return (
    <Section title="Filters">
      <Choice label="Filter method" value={chosen} options={METHODS} onTake={setChosen} />
      <p className="explain">{told.explains}</p>
      {other && (
        <div className="row end">
          <button type="button" className="button" onClick={() => setChosen(method)}>
            Keep {METHODS.find(({ value }) => value === method)?.name}
          </button>
          <button
            type="button"
            className="button primary"
            onClick={() => ask(request(chosen), "Changing the filters")}
          >
            Apply
          </button>
        </div>
      )}
    </Section>
  );
}

function request(method: string) {
  return {
    type: "set_value" as const,
    label: `Use the ${method} method`,
    path: ["method"],
    value: method,
  };
}
