// Forms that decide: beside the evidence, with the champion that they were shown and a reason.
import { useEffect, useRef, useState } from "preact/hooks";
import { logIn, logOut, may, newRequester, order, useSession, type Role } from "./session";

export interface Action {
  action: string;
  label: string;
  role: Role;
  needsReason: boolean;
  version?: string;
}

interface DecideProperties {
  spacecraft: string;
  equipment: string;
  champion: string | null;
  actions: Action[];
}

export function Decide({ spacecraft, equipment, champion, actions }: DecideProperties) {
  const session = useSession();
  const [reason, setReason] = useState("");
  const [sending, setSending] = useState("");
  const [done, setDone] = useState<{ action: string; ok: boolean; reply: string } | null>(null);
  const [failure, setFailure] = useState("");
  // What was shown when the form was opened is what is decided on: another champion since is refused.
  const shown = useRef(champion);
  if (done?.ok) shown.current = champion;  // what one decided oneself is no surprise
  const requesters = useRef(new Map<string, string>());
  const allowed = actions.filter((one) => may(session, one.role, spacecraft));
  if (actions.length === 0) return null;
  if (allowed.length === 0)
    return <p class="note">{session.user ? `${session.user} (${session.role}) may not decide here.` : "The page only shows: nobody is logged in who may decide."}</p>;
  const send = async (one: Action) => {
    const key = `${one.action} ${reason}`;
    if (!requesters.current.has(key)) requesters.current.set(key, newRequester());
    setSending(one.action);
    setFailure("");
    try {
      const reply = await order(requesters.current.get(key)!, { action: one.action, spacecraft, equipment, version: one.version, champion: shown.current, reason });
      requesters.current.delete(key);  // answered: the same words later are another order
      setDone({ action: one.action, ...reply });
    } catch (error) {
      setFailure(String((error as Error).message ?? error));
    }
    setSending("");
  };
  return (
    <form class="decide" onSubmit={(event) => event.preventDefault()}>
      <h2>Decide as {session.user}</h2>
      <label>Reason <textarea rows={2} value={reason} maxLength={500} onInput={(event) => setReason((event.target as HTMLTextAreaElement).value)} /></label>
      <p class="note">Champion now: {shown.current ?? "none"}{shown.current !== champion && <span class="bad"> – {champion ?? "none"} rules since; read again, then <a href={location.hash} onClick={() => location.reload()}>open the form again</a></span>}</p>
      <div class="toolbar">
        {allowed.map((one) => (
          <button type="button" disabled={sending !== "" || (done?.ok === true && done.action === one.action) || (one.needsReason && reason.trim() === "")} onClick={() => send(one)}>
            {sending === one.action ? "Sent …" : one.label}
          </button>
        ))}
      </div>
      {failure && <p class="error" role="alert">{failure}</p>}
      {done && <p class={done.ok ? "good" : "error"} role="status">{done.reply}</p>}
    </form>
  );
}

export function Who() {
  const session = useSession();
  const [open, setOpen] = useState(false);
  if (session.user)
    return <span class="who">{session.user} ({session.role}){session.has_passwords && <> <button type="button" class="quiet" onClick={logOut}>log out</button></>}</span>;
  if (!session.has_passwords) return null;
  return (
    <>
      <button type="button" class="quiet" onClick={() => setOpen(true)}>log in</button>
      {open && <LogIn close={() => setOpen(false)} />}
    </>
  );
}

function LogIn({ close }: { close: () => void }) {
  const dialog = useRef<HTMLDialogElement>(null);
  const [name, setName] = useState("");
  const [password, setPassword] = useState("");
  const [failure, setFailure] = useState("");
  useEffect(() => dialog.current!.showModal(), []);
  const submit = async (event: Event) => {
    event.preventDefault();
    try {
      await logIn(name, password);
      dialog.current?.close();
    } catch (error) {
      setFailure(String((error as Error).message ?? error));
    }
  };
  return (
    <dialog ref={dialog} onClose={close} aria-label="log in">
      <form onSubmit={submit}>
        <h2>Log in</h2>
        <p><label>Name <input autocomplete="username" value={name} onInput={(event) => setName((event.target as HTMLInputElement).value)} /></label></p>
        <p><label>Password <input type="password" autocomplete="current-password" value={password} onInput={(event) => setPassword((event.target as HTMLInputElement).value)} /></label></p>
        {failure && <p class="error" role="alert">{failure}</p>}
        <div class="toolbar"><button type="submit">Log in</button><button type="button" onClick={() => dialog.current!.close()}>Cancel</button></div>
      </form>
    </dialog>
  );
}
