// SPDX-License-Identifier: BSD-3-Clause
#include "AvianLidarErrors.h"

#include "pqActiveObjects.h"
#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPipelineSource.h"
#include "pqServerManagerModel.h"

#include "vtkPVArrayInformation.h"
#include "vtkPVDataInformation.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMProxy.h"
#include "vtkType.h"

#include <QAction>
#include <QApplication>
#include <QPointer>
#include <QWidget>

namespace
{
constexpr char Property[] = "ErrorsAsData";

//------------------------------------------------------------------------------
// Lives as long as the application of the window.
class Errors : public QObject
{
public:
  explicit Errors(pqApplicationCore* application)
    : QObject(application)
  {
    pqServerManagerModel* model = application->getServerManagerModel();
    connect(model, &pqServerManagerModel::preSourceAdded, this, &Errors::Keep);
    connect(model, &pqServerManagerModel::dataUpdated, this, [this] { this->LookAgain(); });
    connect(&pqActiveObjects::instance(), &pqActiveObjects::portChanged, this,
      [this] { this->GuardSaving(); });
    for (pqPipelineSource* source : model->findItems<pqPipelineSource*>())
    {
      this->Keep(source);
    }
  }

private:
  void Keep(pqPipelineSource* source)
  {
    vtkSMProxy* proxy = source->getProxy();
    const std::string name = proxy->GetXMLName() ? proxy->GetXMLName() : "";
    if (name.rfind("AvianLidar", 0) == 0 && proxy->GetProperty(Property))
    {
      vtkSMPropertyHelper(proxy, Property).Set(1);
      proxy->UpdateProperty(Property);
    }
  }

  // What the active output's ranks say of it.
  bool HasError() const
  {
    pqOutputPort* port = pqActiveObjects::instance().activePort();
    vtkPVDataInformation* data = port ? port->getDataInformation() : nullptr;
    vtkPVArrayInformation* error =
      data ? data->GetArrayInformation("error", vtkDataObject::FIELD) : nullptr;
    return error && error->GetDataType() == VTK_STRING;
  }

  // ParaView enables the action for each output that becomes the active one.
  void GuardSaving()
  {
    if (!this->Saving)
    {
      this->Saving = FindAction();
      if (this->Saving)
      {
        connect(this->Saving, &QAction::changed, this, [this] { this->GuardSaving(); });
      }
    }
    if (this->Saving && this->Saving->isEnabled() && this->HasError())
    {
      this->Saving->setEnabled(false);
    }
  }

  // What was bad may be good now: ParaView decides anew.
  void LookAgain()
  {
    for (QObject* reaction : this->Saving ? this->Saving->children() : QObjectList())
    {
      if (reaction->inherits("pqSaveDataReaction"))
      {
        QMetaObject::invokeMethod(reaction, "updateEnableState");
      }
    }
    this->GuardSaving();
  }

  static QAction* FindAction()
  {
    for (QWidget* top : QApplication::topLevelWidgets())
    {
      if (auto* action = top->findChild<QAction*>("actionFileSaveData"))
      {
        return action;
      }
    }
    return nullptr;
  }

  QPointer<QAction> Saving;
};
}

//------------------------------------------------------------------------------
void AvianLidarKeepErrors()
{
  pqApplicationCore* application = pqApplicationCore::instance();
  static QPointer<Errors> errors;
  if (application && application->getServerManagerModel() && !errors)
  {
    errors = new Errors(application);
  }
}
