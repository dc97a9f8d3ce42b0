!> Common scenes of several test programs, built in memory.
module scenes
   use rwmf_core_kinds, only: pi, wp
   use rwmf_problem_case, only: case_t
   implicit none
   private

   public :: rwmf_scene, block_scene, frame_scene

contains

   !> Wall of the paper (h = 2 m, b = 0.5 m) with frame, cable, e = 0.9 and a pulse.
   function rwmf_scene(formulation, gamma, T_s, method) result(case)
      character(*), intent(in) :: formulation
      real(wp), intent(in) :: gamma
      !! mass ratio [-]
      real(wp), intent(in) :: T_s
      !! period [s]
      character(*), intent(in) :: method
      type(case_t) :: case

      case = block_scene(method)
      allocate (case%frame, case%cable)
      case%frame%T_s = T_s
      case%frame%gamma = gamma
      case%frame%xi_s = 0.05_wp
      case%cable%eta_0 = [1.0_wp]
      case%cable%eta_alpha = [5.0_wp]
      case%cable%law = 'linear'
      case%impact%rule = 'constant'
      case%impact%e = 0.9_wp
      case%model%formulation = formulation
   end function rwmf_scene

   !> Free-standing block under a one-sine pulse of 0.4 g.
   function block_scene(method) result(case)
      character(*), intent(in) :: method
      type(case_t) :: case

      allocate (case%wall, case%motion)
      case%wall%h = 2
      case%wall%b = 0.5_wp
      case%impact%rule = 'none'
      case%motion%kind = 'one_sine'
      case%motion%a_max_g = 0.4_wp
      case%motion%omega_p = 2*pi
      case%motion%cycles = 1
      case%motion%t_0 = 0
      case%motion%scale = 1
      case%model%formulation = 'symmetric'
      case%model%g = 9.81_wp
      case%model%overturning_angle = pi/2
      case%solver%method = method
      case%solver%rtol = 1.0e-9_wp
      case%solver%t_end = 10
      case%solver%max_steps = 10000000
      case%solver%verify = .false.
   end function block_scene

   !> Frame without wall under the same pulse.
   function frame_scene(T_s, method) result(case)
      real(wp), intent(in) :: T_s
      !! [s]
      character(*), intent(in) :: method
      type(case_t) :: case

      case = block_scene(method)
      deallocate (case%wall)
      allocate (case%frame)
      case%frame%T_s = T_s
      case%frame%xi_s = 0.05_wp
   end function frame_scene

end module scenes
