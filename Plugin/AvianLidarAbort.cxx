// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarAbort.h"

#include "pqApplicationCore.h"
#include "pqPipelineSource.h"
#include "pqProgressManager.h"
#include "pqServerManagerModel.h"

#include "vtkAlgorithm.h"
#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkNew.h"
#include "vtkSMProxy.h"
#include "vtkWeakPointer.h"

#include <QAbstractButton>
#include <QApplication>
#include <QPointer>
#include <QTimer>

#include <xcb/xcb.h>
#include <xcb/xcbext.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <memory>

#include <string>

namespace
{
using Clock = std::chrono::steady_clock;

//------------------------------------------------------------------------------
// Asks the X server whether the left mouse button is down on a widget. ParaView 5.11 handles no
// events while a filter executes. To handle them here could begin another execution within this
// one (a timer, a drawing); so Qt's events are left alone, and the server is asked by a connection
// of its own.
class Mouse
{
public:
  Mouse()
    : Connection(xcb_connect(nullptr, &this->ScreenNumber), xcb_disconnect)
  {
    if (xcb_connection_has_error(this->Connection.get()))
    {
      return;
    }
    auto screens = xcb_setup_roots_iterator(xcb_get_setup(this->Connection.get()));
    for (int i = 0; i < this->ScreenNumber && screens.rem > 1; ++i)
    {
      xcb_screen_next(&screens);
    }
    this->Root = screens.data->root;
  }

  bool Works() const { return this->Root != 0; }

  // Answers to earlier questions no longer count.
  void Forget()
  {
    if (this->Asked.sequence)
    {
      xcb_discard_reply(this->Connection.get(), this->Asked.sequence);
      this->Asked.sequence = 0;
    }
  }

  // Does not wait for the server, which may be far: asks, and a later call finds the answer.
  bool IsDownOn(const QWidget* widget)
  {
    if (!this->Asked.sequence)
    {
      this->Asked = xcb_query_pointer(this->Connection.get(), this->Root);
      xcb_flush(this->Connection.get());
      return false;
    }
    void* answer = nullptr;
    xcb_generic_error_t* error = nullptr;
    if (!xcb_poll_for_reply(this->Connection.get(), this->Asked.sequence, &answer, &error))
    {
      return false;
    }
    this->Asked.sequence = 0;
    std::free(error);
    const Reply reply(static_cast<xcb_query_pointer_reply_t*>(answer), std::free);
    return reply && (reply->mask & XCB_BUTTON_MASK_1) && this->IsOn(widget);
  }

private:
  using Reply = std::unique_ptr<xcb_query_pointer_reply_t, decltype(&std::free)>;

  bool IsOn(const QWidget* widget) const
  {
    // From the root to the window below the pointer: that of the widget, unless another covers it.
    const auto wanted = static_cast<xcb_window_t>(widget->window()->internalWinId());
    for (xcb_window_t window = this->Root; window;)
    {
      const auto cookie = xcb_query_pointer(this->Connection.get(), window);
      const Reply reply(
        xcb_query_pointer_reply(this->Connection.get(), cookie, nullptr), std::free);
      if (!reply)
      {
        return false;
      }
      if (window == wanted)
      {
        const QPoint point = QPoint(reply->win_x, reply->win_y) / widget->devicePixelRatioF();
        return widget->rect().contains(widget->mapFrom(widget->window(), point));
      }
      window = reply->child;
    }
    return false;
  }

  int ScreenNumber = 0;
  std::unique_ptr<xcb_connection_t, decltype(&xcb_disconnect)> Connection;
  xcb_window_t Root = 0;
  xcb_query_pointer_cookie_t Asked = { 0 };
};

//------------------------------------------------------------------------------
// Lives as long as the progress manager of the window.
class Abort : public QObject
{
public:
  explicit Abort(pqProgressManager* manager)
    : QObject(manager)
    , Manager(manager)
  {
    this->Command->SetClientData(this);
    this->Command->SetCallback([](vtkObject* caller, unsigned long event, void* self, void*)
      { static_cast<Abort*>(self)->Hear(vtkAlgorithm::SafeDownCast(caller), event); });
    connect(manager, &pqProgressManager::progressStartEvent, this, [this] { this->Follow(); });
    connect(manager, &pqProgressManager::abort, this, [this] { this->Stop(); });
  }

  // Algorithms may outlive the window.
  ~Abort() override { this->Command->SetCallback(nullptr); }

private:
  // Hears of the beginning and the end of each algorithm of ours. Those on a server are not here.
  void Follow()
  {
    auto* model = pqApplicationCore::instance()->getServerManagerModel();
    for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
    {
      vtkObjectBase* object = source->getProxy()->GetClientSideObject();
      auto* algorithm = vtkAlgorithm::SafeDownCast(object);
      const bool ours =
        algorithm && std::string(object->GetClassName()).rfind("vtkAvianLidar", 0) == 0;
      if (ours && !algorithm->HasObserver(vtkCommand::StartEvent, this->Command))
      {
        algorithm->AddObserver(vtkCommand::StartEvent, this->Command);
        algorithm->AddObserver(vtkCommand::ProgressEvent, this->Command);
        algorithm->AddObserver(vtkCommand::EndEvent, this->Command);
      }
    }
  }

  void Hear(vtkAlgorithm* algorithm, unsigned long event)
  {
    if (event == vtkCommand::StartEvent)
    {
      this->Start(algorithm);
    }
    else if (algorithm == this->Executing && event == vtkCommand::EndEvent)
    {
      this->End();
    }
    else if (algorithm == this->Executing)
    {
      this->LookAtButton();
    }
  }

  void Start(vtkAlgorithm* algorithm)
  {
    const auto stopped = this->Stopped.find(algorithm);
    if (stopped != this->Stopped.end() && algorithm->GetMTime() > stopped->second)
    {
      this->Stopped.erase(stopped);
      algorithm->SetAbortExecute(0);
    }
    this->Executing = algorithm;
    this->Pointer.Forget();
    this->Button = this->FindButton();
    if (this->Button && this->Pointer.Works() && QGuiApplication::platformName() == "xcb")
    {
      this->Manager->setEnableAbort(true);
    }
  }

  // ParaView's status bar makes its button known to the manager.
  QAbstractButton* FindButton() const
  {
    for (QObject* object : this->Manager->nonBlockableObjects())
    {
      auto* button = qobject_cast<QAbstractButton*>(object);
      if (button && button->objectName() == "AbortButton")
      {
        return button;
      }
    }
    return nullptr;
  }

  void LookAtButton()
  {
    const auto now = Clock::now();
    if (now < this->NextLook || !this->Button || !this->Button->isEnabled() ||
      !this->Button->isVisible())
    {
      return;
    }
    if (this->Pointer.IsDownOn(this->Button))
    {
      this->Manager->triggerAbort();
    }
    this->NextLook = now + std::chrono::milliseconds(2); // a click lasts longer
  }

  void Stop()
  {
    if (this->Executing)
    {
      this->Executing->SetAbortExecute(1);
      this->Manager->setEnableAbort(false);
      if (this->Button)
      {
        this->Button->repaint();
      }
    }
  }

  // The flag stays: VTK executes again what was stopped at the next drawing, unasked, which has to
  // end at once. The next change of a property, or Apply, takes it back.
  void End()
  {
    if (this->Executing->GetAbortExecute())
    {
      this->Stopped[this->Executing] = this->Executing->GetMTime();
      this->OfferAgain(this->Executing);
    }
    this->Executing = nullptr;
    this->Manager->setEnableAbort(false);
  }

  // Apply can be pressed, and executes though no property has changed.
  void OfferAgain(vtkAlgorithm* algorithm)
  {
    auto* model = pqApplicationCore::instance()->getServerManagerModel();
    for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
    {
      if (source->getProxy()->GetClientSideObject() == algorithm)
      {
        // After the Apply that was stopped, which ends with the state "unmodified".
        QTimer::singleShot(0, source, [this, source] { this->OfferAgain(source); });
      }
    }
  }

  void OfferAgain(pqPipelineSource* source)
  {
    source->setModifiedState(pqProxy::MODIFIED);
    auto connection = std::make_shared<QMetaObject::Connection>();
    *connection = connect(source, &pqPipelineSource::modifiedStateChanged, this,
      [source, connection]
      {
        if (source->modifiedState() == pqProxy::UNMODIFIED)
        {
          disconnect(*connection);
          vtkAlgorithm::SafeDownCast(source->getProxy()->GetClientSideObject())->SetAbortExecute(0);
          source->getProxy()->MarkModified(source->getProxy());
        }
      });
  }

  pqProgressManager* Manager;
  Mouse Pointer;
  vtkNew<vtkCallbackCommand> Command;
  vtkWeakPointer<vtkAlgorithm> Executing;
  std::map<vtkAlgorithm*, vtkMTimeType> Stopped; // and when; pointers to be compared only
  QPointer<QAbstractButton> Button;
  Clock::time_point NextLook;
};
}

//------------------------------------------------------------------------------
void AvianLidarAddAbort()
{
  pqApplicationCore* application = pqApplicationCore::instance();
  static QPointer<Abort> abort;
  if (application && application->getProgressManager() && !abort)
  {
    abort = new Abort(application->getProgressManager());
  }
}
